# make speed-error: processor time of one thread against error, for the brain section, a clamped block and a clamped
# cube, by the founding paper's schemes, by the default and by CalculiX; and the time that each takes to 1 % and 0.3 %.
#
# The solutions are those of make convergence, and the cube's, in build/out/convergence; each keeps its time, so that an interrupted
# study goes on. Errors of the fields are means over the nodes, relative to the largest displacement; those of the cube's force
# are relative to its limit, 9.2 N (see pipelines/hard/19-cube.sh).

SPEED_ERROR := $(OUT)/speed-error
SPEED_ERROR_CASES := brain block20 cube
SPEED_ERROR_NAMES := $(call convergence_names,brain block20)
SPEED_ERROR_FORCES := $(call convergence_names,cube)

.PHONY: speed-error
speed-error: $(SPEED_ERROR)/speed-error.tsv $(SPEED_ERROR)/reach.tsv $(SPEED_ERROR)/speed-error.png
	@awk -F '\t' '{ printf "%-8s %-10s %9s %7s %10s %10s %10s %9s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8 }' $<
	@echo
	@awk -F '\t' '{ printf "%-8s %-10s %14s %14s %14s\n", $$1, $$2, $$3, $$4, $$5 }' $(SPEED_ERROR)/reach.tsv

$(SPEED_ERROR)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

$(SPEED_ERROR_FORCES:%=$(CONVERGENCE)/%.force): %.force: %.time
	@mkdir -p $(@D)
	mts print reactions $(@:.force=.dat) | tail -n 1 > $@

$(SPEED_ERROR)/speed-error.tsv: $(SPEED_ERROR_NAMES:%=$(CONVERGENCE)/%.errors) $(SPEED_ERROR_FORCES:%=$(CONVERGENCE)/%.force) \
        pipelines/speed-error/table.awk
	@mkdir -p $(@D)
	awk -f pipelines/speed-error/table.awk -v limit=9.2 $(filter %.errors %.force,$^) > $@

$(SPEED_ERROR)/reach.tsv: $(SPEED_ERROR)/speed-error.tsv pipelines/speed-error/reach.awk
	awk -f pipelines/speed-error/reach.awk $< > $@

$(SPEED_ERROR)/speed-error.png: $(SPEED_ERROR)/speed-error.tsv pipelines/speed-error/picture.gp
	gnuplot -e "data='$<'; cases='$(SPEED_ERROR_CASES)'; out='$@'" pipelines/speed-error/picture.gp
