# From all scenes to the rods' constants, one table and one page.

# What each effect costs is measured once for T = 0 and in every system above.
PRICED = [name for name in SYSTEMS if not SYSTEMS[name].thermal][:1] + [
    name for name in SYSTEMS if SYSTEMS[name].thermal
]
# Where waves were simulated; those of harmonic scenes alone say nothing that the Hessian does not.
SIMULATED = dict.fromkeys(
    scene.system.name
    for scene in SCENES.values()
    if scene.method == "simulated"
    and scene.excitation.kind not in ("none", "static")
    and not scene.system.thermal
)


rule costs:
    input:
        spec="results/systems/{system}/system.json",
        built="results/systems/{system}/built.pdb",
        start=lambda w: start_of(SYSTEMS[w.system]),
    output:
        "results/systems/{system}/costs.csv",
    log:
        "results/logs/costs/{system}.log",
    benchmark:
        "results/benchmarks/costs/{system}.tsv"
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=30,
    message:
        "What each effect of {wildcards.system} costs per step"
    shell:
        "dnawaves costs {input.spec} {input.built} {input.start} --output {output} > {log} 2>&1"


rule constants:
    input:
        spec="results/systems/{system}/system.json",
        built="results/systems/{system}/built.pdb",
        start=lambda w: start_of(SYSTEMS[w.system]),
        modes=lambda w: (
            []
            if SYSTEMS[w.system].thermal
            else [f"results/systems/{w.system}/modes/0-0.nc"]
        ),
        speeds=lambda w: [
            f"results/scenes/{scene.name}/speeds.csv"
            for scene in SCENES.values()
            if scene.system.name == w.system and scene.excitation.kind == "static"
        ],
        motions=lambda w: [
            f"results/scenes/{scene.name}/{member}/motion.nc"
            for scene in in_equilibrium(w.system)
            for member in scene.members
        ],
        helical=lambda w: helical_of(in_equilibrium(w.system)),
    output:
        "results/systems/{system}/constants.csv",
    log:
        "results/logs/constants/{system}.log",
    benchmark:
        "results/benchmarks/constants/{system}.tsv"
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=4000,
        runtime=30,
    params:
        modes=lambda w, input: [f"--modes {path}" for path in input.modes],
        speeds=lambda w, input: [f"--speeds {path}" for path in input.speeds],
        motions=lambda w, input: [f"--motion {path}" for path in input.motions],
        helical=lambda w, input: [f"--helical {path}" for path in input.helical],
    message:
        "Constants of the rod in {wildcards.system}"
    shell:
        "dnawaves constants {input.spec} {input.built} {input.start}"
        " {params.modes} {params.speeds} {params.motions} {params.helical}"
        " --output {output} > {log} 2>&1"


rule compare:
    input:
        speeds=expand("results/scenes/{scene}/speeds.csv", scene=SCENES),
        scenes=expand("results/scenes/{scene}/scene.json", scene=SCENES),
        structures=expand("results/systems/{system}/structure.nc", system=SYSTEMS),
        constants=expand("results/systems/{system}/constants.csv", system=SYSTEMS),
    output:
        report(
            "results/comparison.csv",
            caption="../report/comparison.rst",
            category="Speeds",
        ),
    log:
        "results/logs/compare.log",
    benchmark:
        "results/benchmarks/compare.tsv"
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        scenes=lambda w, input: [f"--scene {path}" for path in input.scenes],
        structures=lambda w, input: [f"--structure {path}" for path in input.structures],
        constants=lambda w, input: [f"--constants {path}" for path in input.constants],
    message:
        "Holding all speeds against the theory"
    shell:
        "dnawaves compare {input.speeds} {params.scenes} {params.structures} {params.constants}"
        " --output {output} > {log} 2>&1"


rule report:
    input:
        "results/comparison.csv",
        [
            f"results/systems/{name}/{file}"
            for name, system in SYSTEMS.items()
            for file in (
                ["structure.nc", "constants.csv"]
                if system.thermal
                else ["structure.nc", "constants.csv", "segments.csv", "modes/0-0.nc"]
            )
        ],
        [start_of(system) for system in SYSTEMS.values()],
        [f"results/systems/{name}/joint.csv" for name in SIMULATED],
        [f"results/systems/{name}/costs.csv" for name in PRICED],
        expand("results/scenes/{scene}/waves.nc", scene=SCENES),
        helical_of(SCENES.values()),
    output:
        report(
            "results/report.html",
            caption="../report/report.rst",
            category="Waves against rod theory",
        ),
    log:
        "results/logs/report.log",
    benchmark:
        "results/benchmarks/report.tsv"
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=10,
    params:
        config=CONFIG,
        # No input: a study takes half an hour, and must not run because its page is shown here.
        studies=lambda w: [
            (path, Path(path).stat().st_mtime_ns)
            for path in (
                "results/accuracy/settings.csv",
                "results/stability/table.csv",
            )
            if Path(path).exists()
        ],
    message:
        "Writing {output}"
    shell:
        "dnawaves report --config {params.config:q} --results results --output {output}"
        " > {log} 2>&1"
