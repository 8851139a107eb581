# From all scenes to one table and one page.


rule compare:
    input:
        speeds=expand("results/scenes/{scene}/speeds.csv", scene=SCENES),
        structures=expand("results/systems/{system}/structure.nc", system=SYSTEMS),
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
        structures=lambda w, input: [f"--structure {path}" for path in input.structures],
    message:
        "Holding all speeds against the theory"
    shell:
        "dnawaves compare {input.speeds} {params.structures} --output {output} > {log} 2>&1"


rule report:
    input:
        "results/comparison.csv",
        expand(
            "results/systems/{system}/{file}",
            system=SYSTEMS,
            file=["structure.nc", "relaxed.nc", "segments.csv", "modes/0-0.nc"],
        ),
        expand("results/scenes/{scene}/waves.nc", scene=SCENES),
        [
            f"results/scenes/{name}/{member}/{sign}.helical.nc"
            for name, scene in SCENES.items()
            if scene.observation.helical
            for member in scene.members
            for sign in scene.signs
        ],
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
    message:
        "Writing {output}"
    shell:
        "dnawaves report --config {params.config:q} --results results --output {output}"
        " > {log} 2>&1"
