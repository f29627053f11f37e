"""A kept law for tests: powers of slip and load, with a covariance of round figures."""

from __future__ import annotations

from typing import Any

from tester.inputs.kept_laws.law_schema import KeptLawModel, law_text

PLAIN: dict[str, Any] = {
    "kept_law": 1,
    "form": "power",
    "formula": "mu = a (v / 0.3)^n (F / 200)^m",
    "kind": "wheel_on_belt",
    "compound": "own",
    "parameters": {
        "a": {"value": 0.6, "logarithm": True},
        "n": {"value": 0.2},
        "m": {"value": -0.1, "fitted": False},
    },
    "constants": {"v0": 0.3, "n0": 200.0},
    "covariance": [[0.0004, 0.0], [0.0, 0.0009]],
    "scatter": 0.03,
    "degrees_of_freedom": 10,
    "describes": "yes",
    "range": {
        "temperature": ["25 degC", "85 degC"], "load": ["100 N", "400 N"], "speed": ["0.1 m/s", "0.4 m/s"],
    },
    "data": [{"source": "2024-01-01T00-00-00-mine", "table": "conditions", "rows": 12, "sha256": "0" * 64}],
    "content": "0" * 64,
}  # fmt: skip


def example(**changed: Any) -> KeptLawModel:
    """Return the law with changed keys, and the hash of its content."""
    model = KeptLawModel.model_validate({**PLAIN, **changed})
    return model.model_copy(update={"content": model.hash()})


def example_text(**changed: Any) -> str:
    """Return the law's file."""
    return law_text(example(**changed))
