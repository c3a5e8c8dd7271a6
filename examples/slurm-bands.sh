#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# One cloth in bands over several nodes: a rank per 16 cores, each with run.threads=16. Submit
# it again to continue from the last checkpoint.
#   sbatch --nodes=4 --ntasks-per-node=4 examples/slurm-bands.sh scene.yaml results
#SBATCH --job-name=weft
#SBATCH --cpus-per-task=16
#SBATCH --time=12:00:00
#SBATCH --signal=TERM@120

# Without B: the signal goes to the ranks, and srun waits for them.
if [ -e "$2/scene.yaml" ]; then
    exec srun --mpi=pmix --cpus-per-task="${SLURM_CPUS_PER_TASK:-1}" \
        weft resume "$2" --quiet --bands "$SLURM_NTASKS"
fi
exec srun --mpi=pmix --cpus-per-task="${SLURM_CPUS_PER_TASK:-1}" \
    weft run "$1" --out "$2" --quiet --bands "$SLURM_NTASKS" --set "run.threads=${SLURM_CPUS_PER_TASK:-1}"
