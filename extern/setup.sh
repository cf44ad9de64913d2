# What run-demo and run-tests share; sourced by them, in the top folder.

# Installs the Debian packages of extern/packages.txt that are missing; does nothing, and needs no rights, when none is.
installMissingPackages() {
  local wanted package missing=()
  wanted=$(sed 's/#.*//' extern/packages.txt)
  for package in $wanted; do
    if [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null) != installed ]]; then
      missing+=("$package")
    fi
  done
  if ((${#missing[@]} == 0)); then return; fi

  local asRoot=()
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      echo "Missing packages. Install them as root with: apt-get install --no-install-recommends ${missing[*]}" >&2
      exit 1
    fi
    asRoot=(sudo)
  fi
  echo "Installing: ${missing[*]}"
  "${asRoot[@]}" apt-get update --quiet
  "${asRoot[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install --yes --quiet --no-install-recommends "${missing[@]}"
}

# Configures and builds the release preset, or only the given targets of it, on all cores.
buildRelease() {
  cmake --preset release
  cmake --build --preset release --parallel "$(nproc)" ${1:+--target "$@"}
}
