"""The queue of one rig: recipes that run one after another. It reaches no rig; ``tester.service`` starts items.

``record`` keeps events, ``fold`` makes the queue of them, ``decide`` says what happens next, ``predict`` when.
"""
