"""A base pair that carries mass moves less, and what it carries counts wherever mass does."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr

from dnawaves.files import read_netcdf, write_json
from dnawaves.scene.models import AddedMass, SceneSpec
from dnawaves.trajectory.steps import simulate_step

ADDED_DA = 50_000.0


@pytest.fixture(scope="module")
def motion(
    relaxed: Any,
    make_scene: Callable[..., SceneSpec],
    make_kick: Callable[..., dict[str, Any]],
    tmp_path_factory: pytest.TempPathFactory,
) -> Callable[..., xr.Dataset]:
    """Return a function of pairs: the free duplex kicked along its axis with mass on these."""
    folder = tmp_path_factory.mktemp("masses")

    def run(*pairs: int) -> xr.Dataset:
        scene = make_scene(relaxed.duplex, make_kick("extension"), duration_ps=1, interval_fs=50)
        masses = tuple(AddedMass(pair=pair, mass_Da=ADDED_DA) for pair in pairs)
        loaded = scene.model_copy(update={"masses": masses})
        write_json(folder / "scene.json", loaded.model_dump(mode="json"))
        files = (relaxed.built_file, relaxed.relaxed_file)
        output = folder / "motion.nc"
        simulate_step(folder / "scene.json", *files, "x1", output, None, [], threads=1)
        return read_netcdf(output)

    return run


def test_the_record_knows_the_mass_and_momentum_is_kept(motion: Callable[..., xr.Dataset]) -> None:
    bare, loaded = motion(), motion(1)
    added = (loaded["mass"] - bare["mass"]).values
    # Six masses of 600 Da are summed up from their atoms: round-off.
    np.testing.assert_allclose(added, [ADDED_DA, 0, 0, 0, 0, 0], atol=1e-6)
    # In proportion to the atoms' own masses: same centre, same radius of gyration.
    np.testing.assert_allclose(loaded["centre"], bare["centre"], atol=1e-9)
    np.testing.assert_allclose(
        loaded["inertia"][0] / loaded["mass"][0], bare["inertia"][0] / bare["mass"][0], rtol=1e-9
    )
    momentum = (loaded["mass"] * loaded["velocity"]).sum("pair")
    put_in = loaded["injected_momentum"]
    # The kicked pairs 1 and 2 at 0.2 Å/ps.
    expected = 0.2 * float(loaded["mass"][:2].sum())
    assert float(np.linalg.norm(put_in[0, 0])) == pytest.approx(expected, rel=1e-9)
    # Forces of single precision do not add up to exactly zero: 1e-5 of 10^4 Da Å/ps in a ps.
    assert float(abs(momentum - put_in).max()) < 1e-5 * expected


def test_a_heavy_pair_hardly_takes_part(motion: Callable[..., xr.Dataset]) -> None:
    bare, loaded = motion(), motion(4)

    def largest(record: xr.Dataset) -> float:
        odd = 0.5 * (record["velocity"].sel(sign=1) - record["velocity"].sel(sign=-1))
        return float(abs(odd[:, 3]).max())

    # It gets what the others lose: at most the momentum put in and all that the energy put in, from
    # 1 kJ/mol = 100 Da (Å/ps)², lets the others have in the opposite direction.
    put_in = float(loaded["difference_kinetic_energy"][0])
    others = float(loaded["mass"].sum() - loaded["mass"][3])
    momentum = float(np.linalg.norm(loaded["injected_momentum"][0, 0]))
    most = (momentum + np.sqrt(2 * 100 * put_in * others)) / float(loaded["mass"][3])
    assert largest(loaded) < most < largest(bare) / 5
    # Same forces, another inertia: the energy of all is still conserved, as without.
    energy = loaded["total_energy"].sel(sign=1)
    assert float(abs(energy - energy[0]).max()) < 0.05 * put_in
