# make uncertainty: where the tumour of the brain section comes to lie when stiffness and nu are uncertain, by 200 samples: mean and 95 %
# band
#
# Everything lies in build/out/uncertainty: cases.tsv, cases/ (a sweep, see pipelines/sweep/sweep.sh), uncertainty.tsv, uncertainty.png.
UNCERTAINTY := $(OUT)/uncertainty
UNCERTAINTY_SCRIPTS := pipelines/uncertainty
UNCERTAINTY_SAMPLES ?= 200
UNCERTAINTY_SEED ?= 1
UNCERTAINTY_REGION := tumour
UNCERTAINTY_PROGRAMS := $(addprefix $(BUILD)/bin/,nodes shapefn mtled mts)
UNCERTAINTY_PLACE := awk -f pipelines/stream.awk -f $(UNCERTAINTY_SCRIPTS)/percentile.awk -f $(UNCERTAINTY_SCRIPTS)/place.awk

.PHONY: uncertainty
uncertainty: $(UNCERTAINTY)/uncertainty.tsv $(UNCERTAINTY)/uncertainty.png
	@awk -F '\t' '{ printf "%-74s %-4s %7s %9s %9s %14s %15s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7 }' $<
	$(PICTURES)

$(UNCERTAINTY)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

$(UNCERTAINTY)/body.msh: $(BRAIN2D_INPUT)/brain2d.geo
	@mkdir -p $(@D)
	gmsh -2 -v 2 $< -setnumber lc 7.3 $(BRAIN2D_SIZES) -o $@

$(UNCERTAINTY)/body.cloud.dat: $(UNCERTAINTY)/body.msh $(UNCERTAINTY_PROGRAMS)
	nodes -u mm -t -o $@ $<

$(UNCERTAINTY)/body.mts: $(UNCERTAINTY)/body.cloud.dat $(UNCERTAINTY_PROGRAMS)
	shapefn -o $@ $<

$(UNCERTAINTY)/cases.tsv: pipelines/neurosurgery/random.awk $(UNCERTAINTY_SCRIPTS)/samples.awk pipelines/uncertainty.mk
	@mkdir -p $(@D)
	awk -f $< -f $(UNCERTAINTY_SCRIPTS)/samples.awk -v samples=$(UNCERTAINTY_SAMPLES) -v seed=$(UNCERTAINTY_SEED) > $@

$(UNCERTAINTY)/cases.done: $(UNCERTAINTY)/cases.tsv $(UNCERTAINTY_SCRIPTS)/brain2d.scene $(UNCERTAINTY)/body.mts $(BRAIN2D_TABLES) \
        $(wildcard pipelines/sweep/*)
	+bash pipelines/sweep/sweep.sh $< $(UNCERTAINTY_SCRIPTS)/brain2d.scene $(UNCERTAINTY)/body.mts $(@D)/cases
	touch $@

$(UNCERTAINTY)/place.dat: $(UNCERTAINTY)/cases.done $(UNCERTAINTY)/body.cloud.dat $(UNCERTAINTY_SCRIPTS)/place.awk \
        $(UNCERTAINTY_SCRIPTS)/percentile.awk pipelines/stream.awk
	for case in $$(awk 'NR > 1 { print $$1 }' $(@D)/cases.tsv); do echo "case $$case"; mts print u $(@D)/cases/$$case.dat; done | \
	    $(UNCERTAINTY_PLACE) -v mesh=$(@D)/body.cloud.dat -v region=$(UNCERTAINTY_REGION) > $@

$(UNCERTAINTY)/uncertainty.tsv: $(UNCERTAINTY)/place.dat $(UNCERTAINTY_SCRIPTS)/percentile.awk $(UNCERTAINTY_SCRIPTS)/table.awk
	awk -f $(UNCERTAINTY_SCRIPTS)/percentile.awk -f $(UNCERTAINTY_SCRIPTS)/table.awk -v region=$(UNCERTAINTY_REGION) $< > $@

$(UNCERTAINTY)/section.plot: $(UNCERTAINTY)/cases.done $(UNCERTAINTY)/body.cloud.dat pipelines/plot/section.awk
	awk -f pipelines/stream.awk -f pipelines/plot/section.awk -v mesh=$(@D)/body.cloud.dat \
	    -v field=$(@D)/cases/$$(awk 'NR == 2 { print $$1 }' $(@D)/cases.tsv).dat > $@

$(UNCERTAINTY)/uncertainty.png: $(UNCERTAINTY)/section.plot $(UNCERTAINTY)/place.dat $(UNCERTAINTY_SCRIPTS)/picture.gp
	gnuplot -e "section='$<'; place='$(@D)/place.dat'; out='$@'; \
	    title='Brain shift when stiffness and nu are uncertain: $(UNCERTAINTY_SAMPLES) samples'" $(UNCERTAINTY_SCRIPTS)/picture.gp
