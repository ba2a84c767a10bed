# make scale: what each stage of the pipe costs for each node (time, bytes, memory) on cubes of ten and a hundred thousand nodes; halos of a
# body in parts; time of an evaluation on up to 1 024 processes, by a model
#
# Everything lies in build/out/scale: stages.tsv, parts.tsv, model.tsv. SCALE_SIZES="22 47 100" adds a million nodes, for which the stages
# need up to 20 GB and half an hour.
SCALE := $(OUT)/scale
SCALE_SIZES ?= 22 47
SCALE_PARTS ?= 2 4 8 16 32 64 128 256 512 1024
SCALE_SCRIPTS := pipelines/scale
SCALE_PROGRAMS := $(addprefix $(BUILD)/bin/,cloud ipoints support shapefn mtled part)
SCALE_LARGEST = $(lastword $(SCALE_SIZES))

.PHONY: scale
scale: $(SCALE)/stages.tsv $(SCALE)/parts.tsv $(SCALE)/model.tsv
	@for table in $^; do awk -F '\t' '{ for (i = 1; i <= NF; i++) printf "%-" (i == 1 ? 22 : 15) "s", $$i; print "" }' \
	    $$table; echo; done

$(SCALE)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

$(SCALE_SIZES:%=$(SCALE)/%.rows): $(SCALE)/%.rows: $(SCALE_SCRIPTS)/stages.sh $(SCALE_SCRIPTS)/measured.py $(SCALE_PROGRAMS)
	@mkdir -p $(@D)
	bash $< $* $(@D) > $@

# Wider supports are not asked for: the halo is that of an evaluation.
$(SCALE)/parts.tsv: $(SCALE_SIZES:%=$(SCALE)/%.rows)
	(for parts in $(SCALE_PARTS); do part -k $$parts -w 1 -v $(@D)/$(SCALE_LARGEST).cloud.mts 2>&1; done) | awk '!/^parts/ || NR == 1' > $@

$(SCALE)/stages.tsv: $(SCALE_SIZES:%=$(SCALE)/%.rows)
	(printf 'stage\tnodes\tus_per_node\tB_written\tB_peak\tB_not_mapped\tGB_not_mapped\n'; \
	    cat $^) > $@

$(SCALE)/model.tsv: $(SCALE_SCRIPTS)/model.awk $(SCALE)/stages.tsv $(SCALE)/parts.tsv
	awk -f $^ > $@
