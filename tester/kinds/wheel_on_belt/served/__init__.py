"""A wheel on a belt for a service and its screens: tables, manual mode, facts from past runs."""
