from dataclasses import make_dataclass
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pytest
from typing_extensions import TypeAliasType, TypeVar

from remqa_data.errors import SchemaError
from remqa_data.tables.fields import Column, struct_of

Scalar = TypeVar("Scalar", bound=np.generic)
ALIAS = TypeAliasType("ALIAS", np.ndarray[Any, np.dtype[Scalar]], type_params=(Scalar,))
"""What numpy 2.5 makes of NDArray: its origin is the alias, no longer ndarray."""


@pytest.mark.parametrize("hint", [npt.NDArray[np.int16], ALIAS[np.int16], np.ndarray, Any])
def test_an_array_is_what_its_column_says_whatever_numpy_makes_of_the_annotation(hint) -> None:
    column = Column("Points.", arrow="int16", columns=("x", "y"))
    record = make_dataclass("Record", [("points", Annotated[hint, column])])
    struct = struct_of(record, {})
    assert struct.type.field("points").type == pa.list_(pa.struct([("x", pa.int16()), ("y", pa.int16())]))
    points = np.array([[1, 2], [3, 4]], np.int16)
    (back,) = struct.from_arrow(struct.to_arrow([record(points)], ""))
    assert back.points.dtype == np.int16
    assert back.points.tolist() == points.tolist()


def test_an_array_whose_column_names_no_type_is_refused() -> None:
    record = make_dataclass("Record", [("points", Annotated[npt.NDArray[np.int16], Column("Points.", columns=("x",))])])
    with pytest.raises(SchemaError, match="columns x needs an Arrow type"):
        struct_of(record, {})
