# Hard cases: one job for each, so that a killed suite goes on. No part of `all`.

from dnawaves.stability.case import cases

HARD_CASES = {
    "stability": list(cases()),
    "stability_smoke": [name for name, case in cases().items() if case.reduced],
}


localrules:
    stability,
    stability_smoke,


rule stability:
    input:
        "results/stability/report.html",


rule stability_smoke:
    input:
        "results/stability_smoke/report.html",


rule stability_case:
    output:
        "results/stability/rows/{case}.json",
    log:
        "results/logs/stability/{case}.log",
    benchmark:
        "results/benchmarks/stability/{case}.tsv"
    wildcard_constraints:
        case="|".join(cases()),
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=20,
    params:
        # A case whose declaration changes runs again, the others do not.
        declared=lambda w: cases()[w.case].model_dump_json(),
    message:
        "Hard case {wildcards.case}"
    shell:
        "dnawaves stability case {wildcards.case} --output {output} > {log} 2>&1"


rule stability_table:
    input:
        lambda w: [
            f"results/stability/rows/{name}.json" for name in HARD_CASES[w.suite]
        ],
    output:
        table="results/{suite}/table.csv",
        page=report(
            "results/{suite}/report.html",
            caption="../report/stability.rst",
            category="Hard cases",
        ),
    log:
        "results/logs/{suite}/table.log",
    benchmark:
        "results/benchmarks/{suite}/table.tsv"
    wildcard_constraints:
        suite="|".join(HARD_CASES),
    conda:
        "../envs/dnawaves.yaml"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    message:
        "Gathering the hard cases of {wildcards.suite}"
    shell:
        "dnawaves stability table {input} --output {output.table} --page {output.page}"
        " > {log} 2>&1"
