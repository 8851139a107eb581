"""Step and pair tables as CSV."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dnawaves.duplex.step_table import read_pair_table, read_step_table
from dnawaves.errors import InputError

HEADER = "frame,time_ps,step,pair_1,pair_2,shift_A,slide_A,rise_A,tilt_deg,roll_deg,twist_deg,flags"


def written(folder: Path, *lines: str) -> Path:
    path = folder / "steps.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_one_frame(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        HEADER,
        "0,0.0,1,A:1-B:3,A:2-B:2,0.1,0.2,3.3,-1,2,34,",
        "0,0.0,2,A:2-B:2,A:3-B:1,0.4,0.5,3.6,-4,5,37,",
    )
    expected = [[0.1, 0.4], [0.2, 0.5], [3.3, 3.6], [-1, -4], [2, 5], [34, 37]]
    np.testing.assert_array_equal(read_step_table(path), expected)


def test_one_of_several_frames(tmp_path: Path) -> None:
    path = written(tmp_path, HEADER, "0,0,1,a,b,1,1,1,1,1,1,", "5,1,1,a,b,2,2,2,2,2,2,")
    np.testing.assert_array_equal(read_step_table(path, frame=5), np.full((6, 1), 2.0))
    with pytest.raises(InputError, match="holds 2 frames; say which one"):
        read_step_table(path)
    with pytest.raises(InputError, match="no rows of frame 3"):
        read_step_table(path, frame=3)


def test_only_the_parameters(tmp_path: Path) -> None:
    path = written(
        tmp_path, "shear_A,stretch_A,stagger_A,buckle_deg,propeller_deg,opening_deg", "1,2,3,4,5,6"
    )
    np.testing.assert_array_equal(read_pair_table(path)[:, 0], [1, 2, 3, 4, 5, 6])


@pytest.mark.parametrize("undefined", ["", "nan", "inf", "x"])
def test_refuses_what_is_no_number(tmp_path: Path, undefined: str) -> None:
    path = written(tmp_path, HEADER, "0,0,1,a,b,1,1,1,1,1,1,", f"0,0,2,b,c,1,1,1,1,{undefined},1,")
    with pytest.raises(InputError, match=f"line 3: roll_deg is '{undefined}'"):
        read_step_table(path)


def test_refuses_a_table_of_something_else(tmp_path: Path) -> None:
    path = written(tmp_path, "frame,shift_A,slide_A,rise_A", "0,1,2,3")
    with pytest.raises(InputError, match="missing: tilt_deg, roll_deg, twist_deg"):
        read_step_table(path)
    with pytest.raises(InputError, match="found no rows"):
        read_step_table(written(tmp_path, HEADER))
    with pytest.raises(InputError, match="cannot be read as a CSV table"):
        read_step_table(tmp_path / "absent.csv")
