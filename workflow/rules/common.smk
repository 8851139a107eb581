from pathlib import Path

from snakemake.exceptions import WorkflowError

from dnawaves.errors import InputError
from dnawaves.scene.load import load_scenes
from dnawaves.scene.pairs import held_counts


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
