# shellcheck shell=bash
# Sourced by tools/test and tools/demo: provides what the machine lacks, as far as that is possible
# without asking. What could not be provided is collected in `missing`, one line each.

missing=()

note() { printf '%s\n' "$*"; }

lack() {
    missing+=("$1")
    note "cannot provide: $1"
}

# Runs a command as root where we are root or may become it without a password.
as_root() {
    if [ "$(id -u)" = 0 ]; then
        "$@"
    elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
        sudo -n "$@"
    else
        return 1
    fi
}

# Installs Debian packages. Lists are fetched only when the first attempt fails; a machine without a
# network fails within seconds, not minutes.
install_packages() {
    command -v apt-get >/dev/null || return 1
    local apt=(env DEBIAN_FRONTEND=noninteractive timeout 600 apt-get
        -o Acquire::Retries=1 -o Acquire::http::Timeout=20 -o DPkg::Lock::Timeout=120 -qq -y)
    note "installing $* ..."
    as_root "${apt[@]}" install --no-install-recommends "$@" >/dev/null 2>&1 ||
        { as_root "${apt[@]}" update >/dev/null 2>&1 &&
            as_root "${apt[@]}" install --no-install-recommends "$@" >/dev/null 2>&1; }
}

have_vulkan_driver() {
    [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ] && return 0
    local folder
    for folder in /usr/share /usr/local/share /etc "${XDG_DATA_HOME:-${HOME:-/nonexistent}/.local/share}"; do
        compgen -G "$folder/vulkan/icd.d/*.json" >/dev/null && return 0
    done
    return 1
}

# A Vulkan driver; Mesa's needs no graphics card.
provide_vulkan() {
    have_vulkan_driver && return
    install_packages mesa-vulkan-drivers libvulkan1 && have_vulkan_driver && return
    lack "a Vulkan driver, so pictures may be skipped (Debian: apt-get install mesa-vulkan-drivers)"
}

# Some crates compile C (zstd), and Rust itself links with cc.
provide_c_compiler() {
    command -v cc >/dev/null && return
    install_packages gcc libc6-dev && command -v cc >/dev/null && return
    lack "a C compiler, so the build will fail (Debian: apt-get install gcc libc6-dev)"
}

# Graphics drivers ask for a folder of the user's own. One that we make goes when we end.
provide_runtime_dir() {
    [ -n "${XDG_RUNTIME_DIR:-}" ] && return
    XDG_RUNTIME_DIR=$(mktemp -d)
    export XDG_RUNTIME_DIR
    # shellcheck disable=SC2064 # the folder of now is meant
    trap "rm -rf '$XDG_RUNTIME_DIR'" EXIT
}
