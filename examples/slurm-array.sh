#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A sweep as a Slurm job array; each task runs its share independently.
#   sbatch --array=1-16 examples/slurm-array.sh sweep.yaml results
#SBATCH --job-name=weft
#SBATCH --cpus-per-task=4
#SBATCH --time=12:00:00
#SBATCH --signal=B:TERM@120

# exec: Slurm's signals then reach weft, which ends its runs with valid results.
exec weft batch "$1" --out "$2" --quiet -j "${SLURM_CPUS_PER_TASK:-1}" \
    --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_MAX"
