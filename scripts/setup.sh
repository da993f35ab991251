# Sourced by scripts/run and scripts/check: installs what is missing, configures and builds the release preset.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

talbot_missing_packages() {
    local package
    grep -v '^#' scripts/packages.txt | while read -r package; do
        [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || printf '%s\n' "$package"
    done
}

talbot_install() {
    local missing
    missing=$(talbot_missing_packages | tr '\n' ' ')
    [ -n "${missing// /}" ] || return 0
    local sudo=""
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || {
            echo "talbot: these packages are missing and there is no sudo to install them: $missing" >&2
            exit 1
        }
        sudo=sudo
    fi
    echo "talbot: installing with ${sudo:+sudo }apt-get: $missing"
    $sudo apt-get update -qq
    # shellcheck disable=SC2086
    $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
}

talbot_build() {
    [ -f build/release/build.ninja ] || cmake --preset release >/dev/null
    cmake --build --preset release "$@"
}
