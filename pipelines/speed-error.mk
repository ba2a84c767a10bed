# make speed-error: processor time of one thread against error, for the brain section, clamped blocks and cubes, by the schemes of convergence
#
# The solutions are those of make convergence, and the cubes', in build/out/convergence; each keeps its time, so that an interrupted
# study goes on. Errors are means over the nodes, relative to the largest displacement. Forces: on the side that is pushed, N, in 2D
# N/m; of the graded meshes, which are a quarter of the block and an eighth of the cube, of that part. Limits: block10 58.1, block20
# 130.3, block20_4999 135.3 N/m, cube 8.9 N (see pipelines/hard/17-block.sh, 19-cube.sh).

SPEED_ERROR := $(OUT)/speed-error
SPEED_ERROR_CASES := brain block10 block20 block20_4999 block10_graded cube cube_4999 cube_graded
SPEED_ERROR_FORCES := $(foreach c,$(filter-out brain,$(SPEED_ERROR_CASES)),$(call convergence_names,$(c)) $(addprefix $(c)-dolfinx-,$($($(c).mesh).sizes)))
SPEED_ERROR_NAMES := $(call convergence_names,brain) $(SPEED_ERROR_FORCES)

.PHONY: speed-error deps-dolfinx
deps-dolfinx:
	bash pipelines/deps.sh dolfinx

speed-error: $(SPEED_ERROR)/speed-error.tsv $(SPEED_ERROR)/reach.tsv $(SPEED_ERROR)/speed-error.png
	@awk -F '\t' '{ printf "%-14s %-9s %7s %7s %10s %8s %8s %14s %10s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8, $$9 }' $<
	@echo
	@awk -F '\t' '{ printf "%-14s %-13s %14s %16s %16s %16s\n", $$1, $$2, $$3, $$4, $$5, $$6 }' $(SPEED_ERROR)/reach.tsv
	$(PICTURES)

$(SPEED_ERROR)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

$(SPEED_ERROR_FORCES:%=$(CONVERGENCE)/%.force): %.force: %.time
	@mkdir -p $(@D)
	mts print reactions $(@:.force=.dat) | tail -n 1 > $@

$(SPEED_ERROR)/speed-error.tsv: $(SPEED_ERROR_NAMES:%=$(CONVERGENCE)/%.errors) $(SPEED_ERROR_FORCES:%=$(CONVERGENCE)/%.force) \
        pipelines/speed-error/table.awk
	@mkdir -p $(@D)
	awk -f pipelines/speed-error/table.awk $(filter %.errors,$^) > $@

$(SPEED_ERROR)/reach.tsv: $(SPEED_ERROR)/speed-error.tsv pipelines/speed-error/reach.awk
	awk -f pipelines/speed-error/reach.awk $< > $@

$(SPEED_ERROR)/speed-error.png: $(SPEED_ERROR)/speed-error.tsv pipelines/speed-error/picture.gp
	gnuplot -e "data='$<'; cases='$(SPEED_ERROR_CASES)'; out='$@'" pipelines/speed-error/picture.gp
