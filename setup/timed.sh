#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# What the steps of make cost: `make SHELL=setup/timed.sh GOAL` adds a line for each to build/times.txt, of its
# seconds of user, system and wall and its commands. `sort -rn build/times.txt | cut -c1-120 | head` says which are dear.
mkdir -p build
spent=$(mktemp) || exit
TIMEFORMAT='%U %S %R'
# low numbers are make's: its jobs' pipe
{ time /bin/bash "$@" 2>&"$err"; } {err}>&2 2>"$spent"
status=$?
printf '%s %s\n' "$(<"$spent")" "$(tr '\n\t' '  ' <<<"${*: -1}" | tail -c 300)" >>build/times.txt
rm -f "$spent"
exit $status
