#!/usr/bin/env bash
# Format and checks of the sources, as CI runs them: clang-format over everything, shellcheck over
# the scripts, clang-tidy (.clang-tidy, all its checks as errors) over the core. Changes nothing.
#   scripts/check.sh               everything, about 2 minutes on two cores
#   scripts/check.sh FILE.cpp...   these sources alone, wherever they are, each by itself
# `git ls-files -z '*.cpp' '*.h' | xargs -0 clang-format-14 -i` mends the format.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# Other versions format and warn otherwise.
version=14
tool() {
  if command -v "$1-$version" >/dev/null; then echo "$1-$version"; return; fi
  if "$1" --version 2>/dev/null | grep -q "version $version\."; then echo "$1"; return; fi
  echo "check.sh: $1 $version is missing; scripts/setup.sh --checks installs it" >&2
  exit 1
}
format=$(tool clang-format)
tidy=$(tool clang-tidy)

if [ $# -gt 0 ]; then
  "$format" --dry-run --Werror "$@"
  cmake --preset debug >/dev/null
  exec "$tidy" -p build/debug --quiet "$@"
fi

if ! command -v shellcheck >/dev/null; then
  echo "check.sh: shellcheck is missing; scripts/setup.sh --checks installs it" >&2
  exit 1
fi
git ls-files -z '*.sh' .ci/run | xargs -0 shellcheck
git ls-files -z '*.cpp' '*.h' | xargs -0 "$format" --dry-run --Werror
echo "check.sh: format of all sources and scripts is right"

# Sources of related folders together (cmake/DkpSlamCheck.cmake), the largest first.
rm -rf build/check/CMakeFiles/check_*
cmake --preset check >/dev/null
mapfile -t units < <(grep -c '#include' build/check/CMakeFiles/check_*.dir/Unity/unity_0_cxx.cxx |
  sort -t: -k2 -nr | cut -d: -f1)
printf '%s\0' "${units[@]}" | xargs -0 -P "$(nproc)" -n 1 "$tidy" -p build/check --quiet 2>&1 |
  sed '/ warnings\? generated\.$/d'  # in headers of others, where it says nothing more
echo "check.sh: clang-tidy found nothing in ${#units[@]} pieces of the core"
