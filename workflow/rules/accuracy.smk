# What accuracy costs: one job for each setting of a study, so that a killed one goes on.


include: "accuracy_studies.smk"
include: "accuracy_settings.smk"


localrules:
    accuracy,
    accuracy_smoke,


rule accuracy:
    input:
        "results/accuracy/report.html",


rule accuracy_smoke:
    input:
        "results/accuracy_smoke/report.html",


rule accuracy_costs:
    input:
        lambda w: study_minimum(w.study, w.study_system),
    output:
        "results/{study}/costs/{study_system}.csv",
    log:
        "results/logs/{study}/costs/{study_system}.log",
    benchmark:
        "results/benchmarks/{study}/costs/{study_system}.tsv"
    wildcard_constraints:
        study="|".join(STUDIES),
        study_system=r"\w+",
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=30,
    params:
        file=lambda w: STUDY_FILES[w.study],
    message:
        "What each effect of {wildcards.study_system} costs per step"
    shell:
        "dnawaves accuracy costs {params.file:q} --system {wildcards.study_system}"
        " --minimum {input} --output {output} > {log} 2>&1"


rule accuracy_tables:
    input:
        lambda w: expand(
            "results/{study}/rows/{setting}.json",
            study=w.study,
            setting=STUDIES[w.study].settings,
        ),
    output:
        settings="results/{study}/settings.csv",
        models="results/{study}/models.csv",
    log:
        "results/logs/{study}/tables.log",
    wildcard_constraints:
        study="|".join(STUDIES),
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    message:
        "Gathering all settings"
    shell:
        "dnawaves accuracy tables {input} --settings {output.settings}"
        " --models {output.models} > {log} 2>&1"


rule accuracy_page:
    input:
        settings="results/{study}/settings.csv",
        models="results/{study}/models.csv",
        costs=lambda w: expand(
            "results/{study}/costs/{system}.csv",
            study=w.study,
            system=STUDIES[w.study].study.costs,
        ),
    output:
        "results/{study}/report.html",
    log:
        "results/logs/{study}/page.log",
    wildcard_constraints:
        study="|".join(STUDIES),
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        config=CONFIG,
        # The page marks their settings.
        scenes=[scene.model_dump_json() for scene in SCENES.values()],
        costs=lambda w, input: [f"--costs {path}" for path in input.costs],
    message:
        "Writing {output}"
    shell:
        "dnawaves accuracy page {input.settings} {input.models} --config {params.config:q}"
        " {params.costs} --output {output} > {log} 2>&1"
