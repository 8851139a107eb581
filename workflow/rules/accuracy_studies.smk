# The studies of accuracy that the workflow knows.

from dnawaves.accuracy.settings import load_study


def study_file(name):
    """Return the study file of the working directory, or the one that is shipped."""
    own = Path("config") / f"{name}.yaml"
    return str(own if own.is_file() else Path(workflow.basedir) / own)


STUDY_FILES = {name: study_file(name) for name in ("accuracy", "accuracy_smoke")}


def loaded_study(path):
    """Return a study; a refusal names file and field."""
    try:
        return load_study(Path(path))
    except InputError as error:
        raise WorkflowError(str(error)) from None


STUDIES = {name: loaded_study(path) for name, path in STUDY_FILES.items()}


def study_minimum(study, system):
    """Return the file of a system's minimum."""
    return f"results/{study}/minima/{system}.npz"
