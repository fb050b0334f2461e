# Sourced by the scripts that check something: `check NAME COMMAND...` runs the command, which has passed when its
# exit code is 0, and prints one line, after a failure also what the command wrote. With CHECK_RESULTS set to a
# file, the result and its seconds are added there for tools/test. `skip NAME REASON` counts what cannot be checked
# here. `checks_passed` tells the exit code of all so far. `stage NAME COMMAND...` runs a command as it is, and adds to
# the file STAGE_TIMES what it took: seconds, those of a core in the program and in the system, and the name.
# shellcheck shell=bash

failed_checks=0

check() {
  local name=$1 begin=${EPOCHREALTIME/./} output result
  shift
  if output=$("$@" 2>&1); then
    echo "ok      $name"
    result=passed
  else
    echo "FAILED  $name"
    printf '%s\n' "$output"
    failed_checks=$((failed_checks + 1))
    result=failed
  fi
  add_result "$result" $((${EPOCHREALTIME/./} - begin)) "$name"
}

skip() {
  echo "skipped $1: $2"
  add_result skipped 0 "$1"
}

add_result() { # with its microseconds
  [ -z "${CHECK_RESULTS:-}" ] || printf '%s %d.%06d %s\n' "$1" $(($2 / 1000000)) $(($2 % 1000000)) "$3" >>"$CHECK_RESULTS"
}

checks_passed() {
  [ "$failed_checks" = 0 ]
}

stage() {
  local TIMEFORMAT="%3R %3U %3S $1"
  # In a shell of its own, which says on its own stderr what a program was killed by. In another one around it, which
  # counts no seconds of what runs in the background.
  (time { ("${@:2}"; exit) 2>&3; }) 3>&2 2>>"$STAGE_TIMES"
}
