#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Slurm for the tests of farm/, which start a cluster of their own: its packages, and none of their services. Where it cannot be
# had this says so, and these tests are skipped.
set -eu
cd "$(dirname "$0")/.."
there() {
  for program in munged slurmctld slurmd sbatch; do
    PATH=$PATH:/usr/sbin:/sbin command -v "$program" >/dev/null || return 1
  done
}
there && exit 0
packages="slurmctld slurmd slurm-client munge"
without() {
  echo "setup: $1: tests of Slurm are skipped. They need: $packages" >&2
  exit 0
}
command -v apt-get >/dev/null || without "there is no apt"
[ "$(id -u)" -eq 0 ] || without "only root installs a scheduler here"
# from Debian 13 on its packages take systemd, unless they find this
release=$(sed -n 's/^VERSION_ID="\([0-9]*\)"/\1/p' /etc/os-release)
[ "${release:-0}" -lt 13 ] || packages="$packages systemd-standalone-sysusers"
mkdir -p build/setup
list=build/setup/slurm.txt
echo "$packages" >"$list"
policy=/usr/sbin/policy-rc.d
if [ ! -e $policy ]; then
  trap 'rm -f $policy' EXIT
  printf '#!/bin/sh\nexit 101\n' >$policy
  chmod 755 $policy
fi
setup/apt.sh "$list" || without "Slurm cannot be installed"
there || without "Slurm was installed in vain"
