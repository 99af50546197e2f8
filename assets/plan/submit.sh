#!/bin/sh
# Submits the parts as a job array, and the job that merges them. Options for sbatch, such as --partition or --time, are
# passed on. To resume after a failure, run it again: complete parts end at once, the others continue.
cd "$(dirname "$0")" || exit
parts=$(sbatch --parsable "$@" parts.sbatch) || exit
# The cluster's name may follow the number. Once all tasks have ended, well or not, the merge says what is missing.
sbatch --dependency="afterany:${parts%%;*}" "$@" merge.sbatch
