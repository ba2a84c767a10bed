# make scale: what each stage of the pipe costs for each node (time, bytes, memory) on cubes of ten and a hundred thousand nodes
#
# The table is build/out/scale/stages.tsv. `make scale NODES=1000000` does something else: the whole pipe on a cube of
# so many nodes, to the displacements, in build/out/scale/NODES/pipe.tsv, with all processors (OMP_NUM_THREADS); `make scale BRAIN=1000000` does so on
# the whole brain with its skull, in build/out/scale/brain-NODES. A million nodes take 12 GB of disk, 16 GB of memory.
SCALE := $(OUT)/scale
SCALE_SIZES ?= 22 47
SCALE_SCRIPTS := pipelines/scale
SCALE_PROGRAMS := $(addprefix $(BUILD)/bin/,cloud ipoints support shapefn mtled)

.PHONY: scale
scale: $(if $(NODES)$(BRAIN),$(NODES:%=$(SCALE)/%/pipe.tsv) $(BRAIN:%=$(SCALE)/brain-%/pipe.tsv),$(SCALE)/stages.tsv)
	@for table in $^; do awk -F '\t' '{ for (i = 1; i <= NF; i++) printf "%-" (i == 1 ? 21 : 14) "s ", $$i; print "" }' \
	    $$table; echo; done

$(SCALE)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

$(SCALE_SIZES:%=$(SCALE)/%.rows): $(SCALE)/%.rows: $(SCALE_SCRIPTS)/stages.sh $(SCALE_SCRIPTS)/measured.py $(SCALE_PROGRAMS)
	@mkdir -p $(@D)
	bash $< $* $(@D) > $@

define SCALE_PIPE
(printf 'stage\tnodes\tprocessor_s\twall_s\tus_per_node\tB_written\tB_peak\tB_not_mapped\tGB_peak\tsteps\n'; cat $(@D)/pipe.rows) > $@
endef

$(SCALE)/%/pipe.tsv: $(SCALE_SCRIPTS)/pipe.sh $(SCALE_SCRIPTS)/measured.py $(SCALE_PROGRAMS)
	bash $< $* $(@D)
	$(SCALE_PIPE)

$(SCALE)/brain-%/pipe.tsv: $(SCALE_SCRIPTS)/pipe.sh $(SCALE_SCRIPTS)/measured.py $(SCALE_PROGRAMS) $(BUILD)/bin/nodes
	bash $< $* $(@D) examples/brain3d
	$(SCALE_PIPE)

$(SCALE)/stages.tsv: $(SCALE_SIZES:%=$(SCALE)/%.rows)
	(printf 'stage\tnodes\tus_per_node\tB_written\tB_peak\tB_not_mapped\tGB_not_mapped\n'; \
	    cat $^) > $@
