#!/bin/sh
# status.sh JOB: what Snakemake asks for of a job of sbatch: running, success or failed. Of a controller without an
# accounting database: scontrol knows a job for some minutes after its end (MinJobAge).
state=$(scontrol --oneliner show job "$1" 2>/dev/null | sed -n 's/.* JobState=\([A-Z_]*\).*/\1/p')
case "$state" in
    COMPLETED) echo success ;;
    PENDING | CONFIGURING | RUNNING | COMPLETING | SUSPENDED | REQUEUED) echo running ;;
    *) echo failed ;;
esac
