#!/usr/bin/env bash
# Sets up a Debian 12 machine to build dkp-slam: system packages, then ONNX Runtime into
# third_party/onnxruntime. Can be run again at any time; does only what is missing.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: scripts/setup.sh [--checks] [--with NAME,...] [--no-apt] [--no-onnxruntime]

  --checks           also what scripts/check.sh needs: clang-format, clang-tidy, shellcheck
  --with NAME,...    also what only some users need:
                       fuzz: clang with libFuzzer, for scripts/fuzz.sh
                       python: for the Python module, its tests and its wheel
                       dense: OctoMap, for `dkp-slam export --octomap`
                       kinect: libfreenect, for a Kinect
                       ros: for ROS 1 bags, RealSense recordings and the ROS node
                       page-tests: a browser and what drives it, for the tests of the live view's page
  --no-apt           leave system packages alone (they are there, or another tool manages them)
  --no-onnxruntime   do not fetch ONNX Runtime; YOLOX then runs on OpenCV's dnn, about 4 times slower
TEXT
}

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
with_checks=0
use_apt=1
use_onnxruntime=1
extras=()
while [ $# -gt 0 ]; do
  case "$1" in
    --checks) with_checks=1 ;;
    --with)
      if [ $# -lt 2 ]; then echo "setup.sh: --with needs a name" >&2; usage >&2; exit 2; fi
      IFS=, read -ra names <<<"$2"
      extras+=("${names[@]}")
      shift ;;
    --no-apt) use_apt=0 ;;
    --no-onnxruntime) use_onnxruntime=0 ;;
    -h|--help) usage; exit 0 ;;
    *) echo "setup.sh: unknown option '$1'" >&2; usage >&2; exit 2 ;;
  esac
  shift
done

did=()
note() { did+=("$1"); echo "== $1"; }

packages=(
  ca-certificates ccache cmake curl g++ git libcpp-httplib-dev make ninja-build
  libceres-dev libcli11-dev libdeflate-dev libeigen3-dev libembree-dev libfmt-dev libgmock-dev libgtest-dev
  libopencv-dev libpng-dev libspdlog-dev libsqlite3-dev libturbojpeg0-dev libyaml-cpp-dev nlohmann-json3-dev pkg-config
)
if [ "$with_checks" -eq 1 ]; then packages+=(clang-format clang-tidy shellcheck); fi
for extra in "${extras[@]}"; do
  case "$extra" in
    fuzz) packages+=(clang-14 libclang-rt-14-dev) ;;
    python)
      packages+=(pybind11-dev python3-dev python3-matplotlib python3-numpy python3-pip python3-pytest
                 python3-wheel) ;;
    dense) packages+=(liboctomap-dev) ;;
    kinect) packages+=(libfreenect-dev) ;;
    ros)
      packages+=(libnav-msgs-dev librosbag-storage-dev libroscpp-dev libsensor-msgs-dev
                 libtf2-msgs-dev python3-roslaunch) ;;
    page-tests) packages+=(chromium) ;;
    *) echo "setup.sh: --with '$extra' is none of: dense, fuzz, kinect, page-tests, python, ros" >&2; exit 2 ;;
  esac
done

installed() {
  [ "$(dpkg-query -W -f='${db:Status-Abbrev}' "$1" 2>/dev/null | cut -c1-2)" = "ii" ]
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

setup_packages() {
  local missing=() package
  for package in "${packages[@]}"; do
    installed "$package" || missing+=("$package")
  done
  # npm fetches ONNX Runtime and what drives the browser; one from elsewhere than Debian will do, and
  # goes with no other.
  if [[ $use_onnxruntime -eq 1 || " ${extras[*]} " == *" page-tests "* ]] && ! command -v npm >/dev/null; then
    missing+=(npm)
  fi
  if [ "${#missing[@]}" -eq 0 ]; then
    note "system packages: all there"
    return
  fi
  if ! command -v apt-get >/dev/null; then
    echo "setup.sh: no apt-get here (made for Debian 12); install the like of: ${missing[*]}" >&2
    exit 1
  fi
  if [ "$(id -u)" -ne 0 ] && ! command -v sudo >/dev/null; then
    echo "setup.sh: needs root or sudo to install: ${missing[*]}" >&2
    exit 1
  fi
  as_root apt-get update -qq || echo "setup.sh: could not refresh the package lists; going on" >&2
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    "${missing[@]}"
  note "system packages: installed ${missing[*]}"
}

without_onnxruntime() {
  note "ONNX Runtime: $1. The build will use OpenCV's dnn for YOLOX (about 4 times slower)"
}

setup_onnxruntime() {
  local pin="$root/scripts/onnxruntime" target="$root/third_party/onnxruntime"
  local version
  version=$(sed -n 's/.*"com.github.asus4.onnxruntime": "\([^"]*\)".*/\1/p' "$pin/package.json")
  if [ "$(cat "$target/VERSION" 2>/dev/null)" = "$version" ] &&
     [ -f "$target/lib/libonnxruntime.so.1" ] && [ -f "$target/include/onnxruntime_cxx_api.h" ]; then
    note "ONNX Runtime: there already (package version $version)"
    return
  fi
  if [ "$(uname -sm)" != "Linux x86_64" ]; then
    without_onnxruntime "the package has no library for $(uname -sm)"
    return
  fi
  if ! command -v npm >/dev/null; then without_onnxruntime "npm is missing"; return; fi

  # The package unpacks to 385 MB, of which the library and the headers are kept.
  local temporary
  mkdir -p "$root/third_party"
  temporary=$(mktemp -d "$root/third_party/.onnxruntime.XXXXXX")
  # shellcheck disable=SC2064  # the path is meant to be filled in now
  trap "rm -rf '$temporary'" EXIT
  cp "$pin/package.json" "$pin/package-lock.json" "$temporary/"
  echo "== fetching ONNX Runtime through npm (150 MB) ..."
  if ! (cd "$temporary" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error \
          --cache "$temporary/cache"); then
    without_onnxruntime "npm could not fetch it (see above)"
    return
  fi
  local package="$temporary/node_modules/com.github.asus4.onnxruntime"
  local library="$package/Plugins/Linux/x64/libonnxruntime.so"
  # The same C and C++ headers serve every platform; the package has them in its iOS part only.
  local headers="$package/Plugins/iOS~/onnxruntime.xcframework/ios-arm64/onnxruntime.framework/Headers"
  if [ ! -f "$library" ] || [ ! -f "$headers/onnxruntime_cxx_api.h" ]; then
    without_onnxruntime "the package does not hold library and headers where they were expected"
    return
  fi
  mkdir -p "$temporary/out/lib" "$temporary/out/include"
  cp "$library" "$temporary/out/lib/libonnxruntime.so.1"  # its SONAME
  ln -s libonnxruntime.so.1 "$temporary/out/lib/libonnxruntime.so"
  cp "$headers"/*.h "$temporary/out/include/"
  cp "$package/LICENSE" "$package/ThirdPartyNotices.txt" "$temporary/out/"
  echo "$version" > "$temporary/out/VERSION"
  rm -rf "$target"
  mv "$temporary/out" "$target"
  rm -rf "$temporary"
  trap - EXIT
  note "ONNX Runtime: package version $version now in third_party/onnxruntime"
}

setup_page_tests() {
  if (cd "$root/viewer/page" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error); then
    note "page tests: npm's packages are in viewer/page/node_modules"
  else
    note "page tests: npm could not fetch its packages (see above); the page's tests will be skipped"
  fi
}

if [ "$use_apt" -eq 1 ]; then setup_packages; else note "system packages: left alone (--no-apt)"; fi
if [ "$use_onnxruntime" -eq 1 ]; then
  setup_onnxruntime
else
  without_onnxruntime "left out (--no-onnxruntime)"
fi
if [[ " ${extras[*]} " == *" page-tests "* ]]; then setup_page_tests; fi

echo
echo "Set-up done:"
printf '  - %s\n' "${did[@]}"
echo "Next: cmake --preset release && cmake --build --preset release"
echo "For a YOLOX model: scripts/fetch_model.sh (without one, the motion detector does the job)"
