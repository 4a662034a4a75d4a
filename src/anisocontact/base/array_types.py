"""Types of arrays by role: one name each, in every file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import scipy

#: Numbers in the units of a case.
Floats = npt.NDArray[np.float64]

#: Local numbers of nodes, cells and facets, as DOLFINx has them.
Locals = npt.NDArray[np.int32]

#: Global numbers, keys of pairs, offsets, places in other arrays.
Ints = npt.NDArray[np.int64]

#: Status and failure of points.
Codes = npt.NDArray[np.int8]

#: Which of some things.
Flags = npt.NDArray[np.bool_]

#: Two numbers, such as those along two axes, as a script gives them.
Pair = Sequence[float]

#: Sparse matrices, by rows.
type Sparse = scipy.sparse.csr_array
