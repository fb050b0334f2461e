# Sourced by the scripts that check something: `check NAME COMMAND...` runs the command, which has passed when its
# exit code is 0, and prints one line, after a failure also what the command wrote. With CHECK_RESULTS set to a
# file, the result is added there for tools/test. `skip NAME REASON` counts what cannot be checked here.
# `checks_passed` tells the exit code of all so far.
# shellcheck shell=bash

failed_checks=0

check() {
  local name=$1 output
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
  [ -z "${CHECK_RESULTS:-}" ] || echo "$result $name" >>"$CHECK_RESULTS"
}

skip() {
  echo "skipped $1: $2"
  [ -z "${CHECK_RESULTS:-}" ] || echo "skipped $1" >>"$CHECK_RESULTS"
}

checks_passed() {
  [ "$failed_checks" = 0 ]
}
