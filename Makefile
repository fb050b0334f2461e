# What a user of robot_vision types. The work is done by tools/*, each in a clean environment (tools/env).

PREFIX ?= /opt/robot_vision

.DEFAULT_GOAL := help
.PHONY: help deps build demo check test fuzz sanitize lint format docs bench train-detector install onnxruntime clean run-deps
.NOTPARALLEL:
MAKEFLAGS += --no-print-directory

help:
	@sed -n 's/^## //p' Makefile

## make demo      build and show the synthetic scene; source=/dev/video0 for a camera, ARGS="name:=value ..." for more
demo: build
	@tools/demo $(if $(source),"source:=$(source)") $(ARGS)

## make check     build, lint and all tests that need no ROS master: in minutes, while one works
check: deps
	@tools/env tools/test --no-master

## make test      everything that can be checked; TESTS=core, python, node or a word of a test's name for a part
test: deps
	@tools/env tools/test $(TESTS)

## make fuzz      throw damaged messages and files at what takes them; MINUTES=10 in all, ARGS="--target raw --seed 1"
fuzz: deps
	@tools/env tools/build fuzz_messages
	@tools/env --source .ws/devel/setup.bash test/fuzz/fuzz.py --minutes $(or $(MINUTES),10) $(ARGS)

## make build     build into .ws; then `source .ws/devel/setup.bash`
build: run-deps
	@tools/env tools/build

## make sanitize  the gtests with AddressSanitizer and UndefinedBehaviorSanitizer; part of make test
sanitize: deps
	@tools/env tools/sanitize

## make lint      formatting and static checks, as listed in .pre-commit-config.yaml
lint: deps
	@tools/env tools/lint

## make format    correct the formatting
format: deps
	@tools/env tools/lint format

## make docs      render the images of docs and write docs/parameters.md; ARGS="demo tags" for some images
docs: deps build
	@tools/env --source .ws/devel/setup.bash tools/docs/render $(ARGS)
	@tools/env tools/parameters

## make bench     measure speed and write BENCHMARKS.md; ARGS=nodes, demo or another part: only print that
bench: deps build
	@tools/env --source .ws/devel/setup.bash test/benchmarks/run $(ARGS)

## make train-detector  train the small network of config/networks on the scene, with PyTorch; ARGS="--seed 2"
train-detector: deps build
	@tools/env --source .ws/devel/setup.bash tools/train_detector $(ARGS)

## make install   into PREFIX (default /opt/robot_vision) below DESTDIR; then `source PREFIX/setup.bash`
install: build
	@tools/env tools/install "$(PREFIX)" "$(DESTDIR)"

## make onnxruntime  for this user, without root: object_detector then runs ONNX models by it, two to four times as fast
onnxruntime: run-deps
	@tools/env tools/onnxruntime

## make deps      install what building, running and testing need (apt, through rosdep and package.xml)
deps:
	@tools/env tools/deps test

run-deps:
	@tools/env tools/deps run

## make clean     remove .ws and build, all that was built
clean:
	rm -rf .ws build
