#!/bin/sh
# Renders the parts with GNU parallel, one at a time on each machine, then merges them. Options for parallel, such as
# --sshlogin a,b, are passed on; the machines must share this directory. To resume after a failure, run it again:
# complete parts end at once, the others continue.
cd "$(dirname "$0")" || exit
# The pause leaves time to write what was rendered.
seq 0 @LAST@ |
  parallel --jobs 1 --workdir . --joblog parallel.log --line-buffer --termseq TERM,60000,KILL,25 "$@" \
    @COMMAND@ || exit
@MERGE@
