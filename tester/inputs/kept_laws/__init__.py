"""Laws of friction that `tester fit -o` keeps as files: read strictly, evaluated with their interval and range.

``law_schema`` defines the content of a file; ``law_value`` reads one, evaluates it, and hands it to whatever takes a
law by its name.
"""
