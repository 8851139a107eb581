import os
import sys
from pathlib import Path

from snakemake.utils import min_version

min_version("9.8")

# The rules' `dnawaves` is the one installed beside this Snakemake, environment activated or not.
os.environ.update(
    PATH=os.pathsep.join([str(Path(sys.executable).parent), *os.get_exec_path()])
)


include: "workflow/rules/common.smk"


wildcard_constraints:
    system="|".join(SYSTEMS),
    scene="|".join(SCENES),
    member="[^/]+",
    sign="plus|minus",


include: "workflow/rules/systems.smk"
include: "workflow/rules/scenes.smk"
include: "workflow/rules/results.smk"
include: "workflow/rules/accuracy.smk"
include: "workflow/rules/stability.smk"


report: "workflow/report/workflow.rst"


localrules:
    all,
    freeze_system,
    freeze_scene,


rule all:
    default_target: True
    input:
        "results/comparison.csv",
        "results/report.html",
