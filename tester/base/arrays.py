"""Types of arrays, for annotations. Importing them does not load numpy, which some commands never need."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Places = NDArray[np.intp]
    Booleans = NDArray[np.bool_]
    Complex = NDArray[np.complex128]
else:
    # Annotations are never evaluated: any name does.
    Array = Places = Booleans = Complex = object
