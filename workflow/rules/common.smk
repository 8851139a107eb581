from pathlib import Path

from snakemake.exceptions import WorkflowError

from dnawaves.errors import InputError
from dnawaves.scene.load import load_scenes
from dnawaves.scene.pairs import fixed_counts, held_counts


def configuration_path(settings, configfiles):
    """Return the one file that declares the scenes, relative to the working directory.

    Snakemake would merge several files and single values into one; a scene must be readable from
    one file, and a merge is no file that a message could name.
    """
    if settings.config:
        raise WorkflowError(
            f"--config: found {dict(settings.config)}; allowed: nothing. "
            "Write the values into a configuration file and give it with --configfile."
        )
    given = settings.configfiles or configfiles[-1:]
    if len(given) > 1:
        raise WorkflowError(
            f"--configfile: found {' '.join(map(str, given))}; allowed: one file."
        )
    path = Path(given[0] if given else "config/config.yaml")
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path


def loaded(path):
    """Return the scenes of a configuration; a refusal names file, scene and field."""
    try:
        return load_scenes(path)
    except InputError as error:
        raise WorkflowError(str(error)) from None


CONFIG = configuration_path(workflow.config_settings, workflow.configfiles)
SCENES = loaded(CONFIG)
SYSTEMS = {scene.system.name: scene.system for scene in SCENES.values()}
# Wildcard constraints; "(?!)" matches nothing.
AT_REST, THERMAL = (
    "|".join(name for name in SYSTEMS if SYSTEMS[name].thermal == thermal) or "(?!)"
    for thermal in (False, True)
)


def modes_for(scene):
    """Return the file of normal modes that a harmonic scene needs, none for a simulated one."""
    first, last = held_counts(scene.ends)
    file = f"results/systems/{scene.system.name}/modes/{first}-{last}.nc"
    return [file] if scene.method == "harmonic" else []


def start_of(system):
    """Return the file that a system's scenes start from: its minimum, or snapshots above 0 K."""
    name = "equilibrated.nc" if system.thermal else "relaxed.nc"
    return f"results/systems/{system.name}/{name}"


def hessian_for(scene):
    """Return the Hessian that a static load's linear answer needs, none for other scenes."""
    file = f"results/systems/{scene.system.name}/hessian.npz"
    return [file] if scene.excitation.kind == "static" else []


def waves_of(system):
    """Return the motion of the scenes whose waves say something of one system's rod at rest."""
    kinds = ("kick", "standing_wave", "pulse", "periodic")
    return [
        f"results/scenes/{scene.name}/{member}/motion.nc"
        for scene in SCENES.values()
        if scene.system.name == system and scene.excitation.kind in kinds
        for member in scene.members
    ]


def in_equilibrium(system):
    """Return a system's scenes above 0 K that fluctuate freely: they know its constants."""
    return [
        scene
        for scene in SCENES.values()
        if scene.system.name == system
        and scene.system.thermal
        and scene.excitation.kind == "none"
        and not any(fixed_counts(scene.ends))
    ]


def helical_of(scenes):
    """Return the helical parameters that scenes record."""
    return [
        f"results/scenes/{scene.name}/{member}/{sign}.helical.nc"
        for scene in scenes
        if scene.observation.helical
        for member in scene.members
        for sign in scene.signs
    ]
