# All cases of a sweep, for make -j -k: called by sweep.sh, which sets what is used here.

SHELL := /bin/bash
export SWEEP_CASES SWEEP_TEMPLATE SWEEP_STREAM SWEEP_FOLDER
SWEEP_ROWS := $(shell awk -f $(SWEEP_SCRIPTS)/scene.awk -v list=1 -v stream="$$SWEEP_STREAM" "$$SWEEP_CASES" "$$SWEEP_TEMPLATE")

.PHONY: all $(SWEEP_ROWS:%=case/%)
all: $(SWEEP_ROWS:%=case/%)

$(SWEEP_ROWS:%=case/%): case/%:
	@bash $(SWEEP_SCRIPTS)/case.sh "$$SWEEP_CASES" "$$SWEEP_TEMPLATE" "$$SWEEP_STREAM" "$$SWEEP_FOLDER" '$*'
