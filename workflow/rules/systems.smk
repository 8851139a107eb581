# From a sequence, or a user's structure, to the minimum or the snapshots that every scene of a
# system starts from.


rule freeze_system:
    output:
        "results/systems/{system}/system.json",
    log:
        "results/logs/freeze_system/{system}.log",
    benchmark:
        "results/benchmarks/freeze_system/{system}.tsv"
    conda:
        "../envs/dnawaves.yaml"
    resources:
        mem_mb=500,
        runtime=5,
    params:
        # What the system is decides whether anything runs again, not the file that declares it:
        # Snakemake compares the text, but not a Path.
        spec=lambda wildcards: SYSTEMS[wildcards.system].model_dump_json(),
        config=CONFIG,
    message:
        "Freezing the system {wildcards.system}"
    shell:
        "dnawaves freeze {params.config:q} --system {wildcards.system}"
        " --output {output} > {log} 2>&1"


rule build:
    input:
        spec="results/systems/{system}/system.json",
        file=lambda w: SYSTEMS[w.system].duplex.file or [],
    output:
        "results/systems/{system}/built.pdb",
    log:
        "results/logs/build/{system}.log",
    benchmark:
        "results/benchmarks/build/{system}.tsv"
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=10,
    message:
        "Building {wildcards.system}"
    shell:
        "dnawaves build {input.spec} --output {output} > {log} 2>&1"


rule relax:
    input:
        spec="results/systems/{system}/system.json",
        built="results/systems/{system}/built.pdb",
    output:
        relaxed="results/systems/{system}/relaxed.nc",
        hessian="results/systems/{system}/hessian.npz",
    log:
        "results/logs/relax/{system}.log",
    benchmark:
        "results/benchmarks/relax/{system}.tsv"
    wildcard_constraints:
        system=AT_REST,
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=6000,
        runtime=120,
    message:
        "Relaxing {wildcards.system}"
    shell:
        "dnawaves relax {input.spec} {input.built} --output {output.relaxed}"
        " --hessian {output.hessian} --threads {threads} > {log} 2>&1"


rule equilibrate:
    input:
        spec="results/systems/{system}/system.json",
        built="results/systems/{system}/built.pdb",
    output:
        "results/systems/{system}/equilibrated.nc",
    log:
        "results/logs/equilibrate/{system}.log",
    benchmark:
        "results/benchmarks/equilibrate/{system}.tsv"
    wildcard_constraints:
        system=THERMAL,
    conda:
        "../envs/dnawaves.yaml"
    # One thread gives the same digits every time; water is too slow for that.
    threads: lambda w: 2 if SYSTEMS[w.system].explicit else 1
    resources:
        mem_mb=4000,
        runtime=720,
    message:
        "Equilibrating {wildcards.system}"
    shell:
        "dnawaves equilibrate {input.spec} {input.built} --output {output}"
        " --threads {threads} > {log} 2>&1"


rule modes:
    input:
        spec="results/systems/{system}/system.json",
        built="results/systems/{system}/built.pdb",
        relaxed="results/systems/{system}/relaxed.nc",
        hessian="results/systems/{system}/hessian.npz",
    output:
        # Named by the number of base pairs held at either end.
        "results/systems/{system}/modes/{first}-{last}.nc",
    log:
        "results/logs/modes/{system}.{first}-{last}.log",
    benchmark:
        "results/benchmarks/modes/{system}.{first}-{last}.tsv"
    wildcard_constraints:
        system=AT_REST,
        first=r"\d+",
        last=r"\d+",
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=4000,
        runtime=60,
    message:
        "Normal modes of {wildcards.system} with {wildcards.first} and {wildcards.last} held"
    shell:
        "dnawaves modes {input.spec} {input.built} {input.relaxed} {input.hessian}"
        " --first {wildcards.first} --last {wildcards.last} --output {output} > {log} 2>&1"


rule segments:
    input:
        "results/systems/{system}/modes/0-0.nc",
    output:
        "results/systems/{system}/segments.csv",
    log:
        "results/logs/segments/{system}.log",
    benchmark:
        "results/benchmarks/segments/{system}.tsv"
    wildcard_constraints:
        system=AT_REST,
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    message:
        "Stiffness of the segments of {wildcards.system}"
    shell:
        "dnawaves segments {input} --output {output} > {log} 2>&1"


rule inspect:
    input:
        spec="results/systems/{system}/system.json",
        built="results/systems/{system}/built.pdb",
        start=lambda w: start_of(SYSTEMS[w.system]),
    output:
        structure="results/systems/{system}/structure.nc",
        base_atoms="results/systems/{system}/base_atoms.pdb",
        relaxed="results/systems/{system}/relaxed.pdb",
    log:
        "results/logs/inspect/{system}.log",
    benchmark:
        "results/benchmarks/inspect/{system}.tsv"
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    message:
        "Checking that {wildcards.system} is B-DNA"
    shell:
        "dnawaves inspect {input.spec} {input.built} {input.start} --output {output.structure}"
        " --base-atoms {output.base_atoms} --structure {output.relaxed} > {log} 2>&1"
