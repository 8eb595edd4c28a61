# Sourced by the other scripts: installs what is missing, and builds. Asks nothing.
#
# Every dependency is a Debian 12 package, listed here by name and nowhere else.

packages_build=(
  build-essential cmake ninja-build ccache pkg-config
  libboost1.81-dev libgrpc++-dev libprotobuf-dev protobuf-compiler protobuf-compiler-grpc
  libeigen3-dev libspdlog-dev libfmt-dev libcli11-dev nlohmann-json3-dev libfast-float-dev
  libtomlplusplus-dev
)
packages_gui=(qt6-base-dev)
packages_test=(
  catch2 xvfb xauth xdotool x11-apps
  gcc-arm-none-eabi libstdc++-arm-none-eabi-newlib qemu-system-arm
)
packages_load=(stress-ng)
packages_lint=(clang-16 libclang-rt-16-dev clang-tidy-16 clang-format)

# ensure_packages NAME...: one apt call for those that are missing, none if all are there.
ensure_packages() {
  local missing=() name
  for name in "$@"; do
    dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null | grep -qx installed || missing+=("$name")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  echo "Installing: ${missing[*]}"
  local root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "Run as root, or install sudo: apt has to install packages." >&2; return 1; }
    root=(sudo)
  fi
  "${root[@]}" apt-get update -qq
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# build_preset PRESET [TARGET...]
build_preset() {
  local preset=$1
  shift
  cmake --preset "$preset" >"${TMPDIR:-/tmp}/cnc-configure.$$" 2>&1 || {
    cat "${TMPDIR:-/tmp}/cnc-configure.$$" >&2
    return 1
  }
  rm -f "${TMPDIR:-/tmp}/cnc-configure.$$"
  cmake --build --preset "$preset" ${1:+--target "$@"}
}
