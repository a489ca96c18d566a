#!/usr/bin/env bash
# Builds the live view's page from viewer/page/src, and script and style of the reports from
# viewer/page/report. What it makes is part of the repository and of the program, so that building
# the program needs no npm.
#   scripts/build_page.sh           into viewer/page/built and dkp_slam/evaluation/report/page
#   scripts/build_page.sh --check   changes nothing; fails where the built files are not the sources'
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../viewer/page"

if [ "${1:-}" != "" ] && [ "$1" != "--check" ]; then
  echo "usage: scripts/build_page.sh [--check]" >&2
  exit 2
fi
node_major=$(node --version | sed 's/^v\([0-9]*\).*/\1/')
if [ "$node_major" -lt 20 ]; then
  if [ "${1:-}" = "--check" ]; then
    echo "build_page.sh: skipped: vite needs node 20 or newer, this is $(node --version)"
    exit
  fi
  echo "build_page.sh: vite needs node 20 or newer, this is $(node --version)" >&2
  exit 1
fi
if [ ! -d node_modules/vite ]; then
  npm ci --ignore-scripts --no-audit --no-fund --loglevel=error
fi
build() {
  npx vite build --logLevel warn
  npx vite build --logLevel warn --config vite.report.config.js
}
report=../../dkp_slam/evaluation/report/page
if [ "${1:-}" != "--check" ]; then
  build
  exit
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
PAGE_FOLDER=$folder/page REPORT_FOLDER=$folder/report build
if ! diff -rq built "$folder/page" || ! diff -rq "$report" "$folder/report"; then
  echo "build_page.sh: the built pages are not what the sources give; run scripts/build_page.sh" >&2
  exit 1
fi
echo "build_page.sh: the built pages are what the sources give"
