# From a scene to its motion and its fitted speeds.


rule freeze_scene:
    output:
        "results/scenes/{scene}/scene.json",
    log:
        "results/logs/freeze_scene/{scene}.log",
    benchmark:
        "results/benchmarks/freeze_scene/{scene}.tsv"
    conda:
        "../envs/dnawaves.yaml"
    resources:
        mem_mb=500,
        runtime=5,
    params:
        # As in freeze_system: editing one scene must not run the others again.
        spec=lambda wildcards: SCENES[wildcards.scene].model_dump_json(),
        config=CONFIG,
    message:
        "Freezing the scene {wildcards.scene}"
    shell:
        "dnawaves freeze {params.config:q} --scene {wildcards.scene}"
        " --output {output} > {log} 2>&1"


rule simulate:
    input:
        scene="results/scenes/{scene}/scene.json",
        built=lambda w: f"results/systems/{SCENES[w.scene].system.name}/built.pdb",
        start=lambda w: start_of(SCENES[w.scene].system),
        hessian=lambda w: hessian_for(SCENES[w.scene]),
        fitted=lambda w: [
            f"results/scenes/{source}/speeds.csv" for source in SCENES[w.scene].needs
        ],
        modes=lambda w: modes_for(SCENES[w.scene]),
    output:
        motion="results/scenes/{scene}/{member}/motion.nc",
    log:
        "results/logs/simulate/{scene}.{member}.log",
    benchmark:
        "results/benchmarks/simulate/{scene}.{member}.tsv"
    wildcard_constraints:
        scene="|".join(name for name in SCENES if not SCENES[name].observation.helical)
        or "(?!)",
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=240,
    params:
        fitted=lambda w, input: [
            f"--fitted results/scenes/{source}/speeds.csv"
            for source in SCENES[w.scene].needs
        ],
        hessian=lambda w, input: f"--hessian {input.hessian}" if input.hessian else "",
        modes=lambda w, input: f"--modes {input.modes}" if input.modes else "",
        trajectory=lambda w, output: (
            f"--trajectory {output.trajectory}"
            if "trajectory" in output.keys()
            else ""
        ),
    message:
        "Simulating {wildcards.scene}, {wildcards.member}"
    shell:
        "dnawaves simulate {input.scene} {input.built} {input.start}"
        " --member {wildcards.member} --output {output.motion}"
        " {params.trajectory} {params.fitted} {params.hessian} {params.modes}"
        " --threads {threads} > {log} 2>&1"


use rule simulate as simulate_with_trajectory with:
    output:
        motion="results/scenes/{scene}/{member}/motion.nc",
        trajectory=directory("results/scenes/{scene}/{member}/trajectory"),
    wildcard_constraints:
        scene="|".join(name for name in SCENES if SCENES[name].observation.helical)
        or "(?!)",


rule helical:
    input:
        topology=lambda w: f"results/systems/{SCENES[w.scene].system.name}/base_atoms.pdb",
        trajectory="results/scenes/{scene}/{member}/trajectory",
    output:
        "results/scenes/{scene}/{member}/{sign}.helical.nc",
    log:
        "results/logs/helical/{scene}.{member}.{sign}.log",
    benchmark:
        "results/benchmarks/helical/{scene}.{member}.{sign}.tsv"
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=30,
    message:
        "Helical parameters of {wildcards.scene}, {wildcards.member}, {wildcards.sign}"
    shell:
        "dnawaves helical {input.topology} {input.trajectory}/{wildcards.sign}.dcd"
        " --output {output} > {log} 2>&1"


rule analyse:
    input:
        scene="results/scenes/{scene}/scene.json",
        motions=lambda w: [
            f"results/scenes/{w.scene}/{member}/motion.nc"
            for member in SCENES[w.scene].members
        ],
    output:
        speeds="results/scenes/{scene}/speeds.csv",
        waves="results/scenes/{scene}/waves.nc",
    log:
        "results/logs/analyse/{scene}.log",
    benchmark:
        "results/benchmarks/analyse/{scene}.tsv"
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=60,
    message:
        "Fitting the speeds of {wildcards.scene}"
    shell:
        "dnawaves analyse {input.scene} {input.motions}"
        " --output {output.speeds} --waves {output.waves} > {log} 2>&1"


rule joint:
    input:
        motions=lambda w: waves_of(w.system),
    output:
        "results/systems/{system}/joint.csv",
    log:
        "results/logs/joint/{system}.log",
    benchmark:
        "results/benchmarks/joint/{system}.tsv"
    wildcard_constraints:
        system=AT_REST,
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=30,
    message:
        "Fitting one rod to all waves of {wildcards.system}"
    shell:
        "dnawaves joint {input.motions} --output {output} > {log} 2>&1"
