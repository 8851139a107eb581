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


def modes_for(scene):
    """Return the file of normal modes that a harmonic scene needs, none for a simulated one."""
    first, last = held_counts(scene.ends)
    file = f"results/systems/{scene.system.name}/modes/{first}-{last}.nc"
    return [file] if scene.method == "harmonic" else []
