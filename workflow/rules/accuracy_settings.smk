# One setting of a study: from its system's minimum and known answer to its row.


rule accuracy_relax:
    output:
        "results/{study}/minima/{study_system}.npz",
    log:
        "results/logs/{study}/relax/{study_system}.log",
    benchmark:
        "results/benchmarks/{study}/relax/{study_system}.tsv"
    wildcard_constraints:
        study="|".join(STUDIES),
        study_system=r"\w+",
    # The longest first.
    priority: 10
    conda:
        "../envs/dnawaves.yaml"
    threads: 2
    resources:
        mem_mb=4000,
        runtime=60,
    params:
        file=lambda w: STUDY_FILES[w.study],
        spec=lambda w: STUDIES[w.study].systems[w.study_system].model_dump_json(),
    message:
        "Relaxing {wildcards.study_system}"
    shell:
        "dnawaves accuracy relax {params.file:q} --system {wildcards.study_system}"
        " --output {output} --threads {threads} > {log} 2>&1"


rule accuracy_truth:
    input:
        lambda w: study_minimum(w.study, STUDIES[w.study].cases[w.case].system),
    output:
        "results/{study}/truth/{case}.npz",
    log:
        "results/logs/{study}/truth/{case}.log",
    benchmark:
        "results/benchmarks/{study}/truth/{case}.tsv"
    wildcard_constraints:
        study="|".join(STUDIES),
        case=r"\w+",
    priority: 5
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=3000,
        runtime=60,
    params:
        file=lambda w: STUDY_FILES[w.study],
        spec=lambda w: STUDIES[w.study].cases[w.case].model_dump_json()
        + STUDIES[w.study].study.truth.model_dump_json(),
    message:
        "What {wildcards.case} converges to"
    shell:
        "dnawaves accuracy truth {params.file:q} --case {wildcards.case} --minimum {input}"
        " --output {output} > {log} 2>&1"


rule accuracy_setting:
    input:
        minimum=lambda w: study_minimum(
            w.study, STUDIES[w.study].settings[w.setting].case.system
        ),
        usual=lambda w: study_minimum(
            w.study, STUDIES[w.study].settings[w.setting].usual.system
        ),
        known=lambda w: "results/{}/truth/{}.npz".format(
            w.study, STUDIES[w.study].settings[w.setting].case_name
        ),
    output:
        "results/{study}/rows/{setting}.json",
    log:
        "results/logs/{study}/settings/{setting}.log",
    benchmark:
        "results/benchmarks/{study}/settings/{setting}.tsv"
    wildcard_constraints:
        study="|".join(STUDIES),
        setting="[^/]+",
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=60,
    params:
        file=lambda w: STUDY_FILES[w.study],
        spec=lambda w: STUDIES[w.study].settings[w.setting].model_dump_json(),
    message:
        "Measuring {wildcards.setting}"
    shell:
        "dnawaves accuracy setting {params.file:q} --name {wildcards.setting}"
        " --minimum {input.minimum} --usual {input.usual} --known {input.known}"
        " --output {output} > {log} 2>&1"
