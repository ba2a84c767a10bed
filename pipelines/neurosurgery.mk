# make neurosurgery: a craniotomy from a label image to a warped scan: the shift of a brain (Colin27) predicted from 200 noisy points of the
# exposed cortex, without and with gravity, against a finer solution
#
# Everything lies in build/out/neurosurgery: neurosurgery.tsv (errors before and after), volumes.tsv, seconds.tsv, pictures. The scan is
# that of Debian's mricron-data; where it is not installed the label image stands in for it.
NEURO := $(OUT)/neurosurgery
NEURO_INPUT := examples/neurosurgery
NEURO_LABELS := $(NEURO_INPUT)/colin27_labels.nii.gz
NEURO_SCAN ?= $(firstword $(wildcard /usr/share/mricron/templates/ch2.nii.gz) $(NEURO_LABELS))
NEURO_SCRIPTS := pipelines/neurosurgery
# Spacing of the nodes of the prediction and of the true state.
NEURO_SPACING ?= 9mm
NEURO_TRUE_SPACING ?= 7mm
NEURO_GROUPS := -u mm -f 'stem=ball:0,-41,-65,12' -f 'exposed=ball:63.5,16,20,33' -f 'cortex=all without stem without exposed'
NEURO_RANDOM := awk -f $(NEURO_SCRIPTS)/random.awk
NEURO_TIMED := bash $(NEURO_SCRIPTS)/timed.sh
NEURO_PROGRAMS := $(addprefix $(BUILD)/bin/,voxels groups shapefn mtled interp sample warp mts)
# What is predicted: from the exposed cortex alone, and knowing as well how the patient lies.
NEURO_PREDICTIONS := craniotomy position
NEURO_LOG = 2> $(@:.dat=.log) || { cat $(@:.dat=.log) >&2; false; }

.PHONY: neurosurgery
neurosurgery: $(addprefix $(NEURO)/,neurosurgery.tsv volumes.tsv seconds.tsv slices.png)
	@awk -F '\t' '{ printf "%-56s %12s %12s %12s\n", $$1, $$2, $$3, $$4 }' $<
	@echo
	@awk -F '\t' '{ printf "%-18s %12s %12s %12s %12s\n", $$1, $$2, $$3, $$4, $$5 }' $(NEURO)/volumes.tsv
	@echo
	@awk -F '\t' '{ printf "%-18s %12s\n", $$1, $$2 }' $(NEURO)/seconds.tsv

$(NEURO)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

# ---- the true state, and what is measured of it ----------------------------------------------------------------------

$(NEURO)/%.scene: $(NEURO_INPUT)/%.scene
	@mkdir -p $(@D)
	cp $< $@

$(NEURO)/skull.tsv: $(NEURO_LABELS) $(NEURO_INPUT)/brain.tsv $(NEURO_PROGRAMS)
	@mkdir -p $(@D)
	voxels $< -h 6mm -l $(NEURO_INPUT)/brain.tsv --surface 'brain|outside' --gap 2mm > $@

$(NEURO)/true.u.dat: $(NEURO_LABELS) $(NEURO_INPUT)/labels.tsv $(NEURO)/truth.scene $(NEURO)/skull.tsv $(NEURO_PROGRAMS)
	(voxels $< -h $(NEURO_TRUE_SPACING) -l $(NEURO_INPUT)/labels.tsv | groups $(NEURO_GROUPS) | shapefn | \
	    mtled -v $(NEURO)/truth.scene) > $@ $(NEURO_LOG)

$(NEURO)/measured.tsv: $(NEURO)/true.u.dat $(NEURO_SCRIPTS)/measured.awk $(NEURO_SCRIPTS)/random.awk pipelines/stream.awk
	$(NEURO_RANDOM) -f pipelines/stream.awk -f $(NEURO_SCRIPTS)/measured.awk -v field=$< -v points=200 -v noise=0.5 > $@

# ---- prediction ------------------------------------------------------------------------------------------------------

# Less noise: moving least squares, linear, over 15 mm.
$(NEURO)/exposed.tsv: $(NEURO)/measured.tsv $(NEURO_SCRIPTS)/points.awk $(NEURO_PROGRAMS)
	grep -v '^#' $< | cut -f 1-3 > $(@:.tsv=.places)
	awk -f $(NEURO_SCRIPTS)/points.awk $< | interp -f u -p $(@:.tsv=.places) -u mm -b mls1 -R 15mm > $(@:.tsv=.smooth)
	paste $(@:.tsv=.places) <(mts print u $(@:.tsv=.smooth) | awk '{ print 1e3 * $$1, 1e3 * $$2, 1e3 * $$3 }') > $@

$(NEURO)/predicted.body.mts: $(NEURO_LABELS) $(NEURO_INPUT)/labels.tsv $(NEURO_PROGRAMS)
	@mkdir -p $(@D)
	$(NEURO_TIMED) $(@:.mts=.seconds) "voxels $< -h $(NEURO_SPACING) -l $(NEURO_INPUT)/labels.tsv | groups $(NEURO_GROUPS) > $@"

$(NEURO)/predicted.table.mts: $(NEURO)/predicted.body.mts $(NEURO_PROGRAMS)
	$(NEURO_TIMED) $(@:.mts=.seconds) "shapefn $< > $@"

$(NEURO_PREDICTIONS:%=$(NEURO)/%.u.dat): %.u.dat: $(NEURO)/predicted.table.mts %.scene $(NEURO)/exposed.tsv $(NEURO)/skull.tsv $(NEURO_PROGRAMS)
	$(NEURO_TIMED) $(@:.dat=.seconds) "mtled -v $*.scene $< > $@" $(NEURO_LOG)

$(NEURO)/%.scan.nii.gz: $(NEURO)/%.u.dat $(NEURO_PROGRAMS)
	$(NEURO_TIMED) $(@:.nii.gz=.seconds) "warp -i linear --vacated 0 $(NEURO_SCAN) $< > $@"

$(NEURO)/%.labels.nii.gz: $(NEURO)/%.u.dat $(NEURO_PROGRAMS)
	warp -v -i nearest --vacated 0 $(NEURO_LABELS) $< 2> $(@:.nii.gz=.log) > $@ || { cat $(@:.nii.gz=.log) >&2; false; }

# ---- tables ----------------------------------------------------------------------------------------------------------

# 50 places within the brain.
$(NEURO)/landmarks.tsv: $(NEURO_LABELS) $(NEURO_SCRIPTS)/places.awk $(NEURO_SCRIPTS)/random.awk $(NEURO_PROGRAMS)
	@mkdir -p $(@D)
	$(NEURO_RANDOM) -f $(NEURO_SCRIPTS)/places.awk -v count=200 -v low=-72,-106,-66 -v high=72,73,84 > $(@:.tsv=.places)
	sample -i nearest -p $(@:.tsv=.places) -u mm $< | awk '!/^#/ && $$4 > 0 && n < 50 { n++; print $$1, $$2, $$3 }' > $@

$(NEURO)/ventricles.tsv: $(NEURO_LABELS) $(NEURO_INPUT)/labels.tsv $(NEURO_PROGRAMS)
	@mkdir -p $(@D)
	voxels $< -h 4mm -l $(NEURO_INPUT)/labels.tsv --surface ventricles > $@

$(NEURO)/ventricles.corners: $(NEURO)/ventricles.tsv
	awk '!/^#/ { for (i = 1; i <= 7; i += 3) print 1e3 * $$i, 1e3 * $$(i + 1), 1e3 * $$(i + 2) }' $< > $@

$(NEURO)/%.landmarks: $(NEURO)/%.u.dat $(NEURO)/landmarks.tsv $(NEURO_PROGRAMS)
	interp -f u -p $(NEURO)/landmarks.tsv -u mm $< | mts print u - > $@

$(NEURO)/%.ventricles: $(NEURO)/%.u.dat $(NEURO)/ventricles.corners $(NEURO_PROGRAMS)
	interp -f u -p $(NEURO)/ventricles.corners -u mm $< | mts print u - > $@

$(NEURO)/neurosurgery.tsv: $(foreach kind,landmarks ventricles,$(patsubst %,$(NEURO)/%.$(kind),true $(NEURO_PREDICTIONS))) \
        $(NEURO)/ventricles.tsv $(NEURO_SCRIPTS)/target.awk $(NEURO_SCRIPTS)/surface.awk
	(printf 'distance from the true state\tunpredicted\tfrom_cortex\twith_gravity\n'; awk -f $(NEURO_SCRIPTS)/target.awk $(filter %.landmarks,$^); \
	    awk -f $(NEURO_SCRIPTS)/surface.awk -v triangles=$(NEURO)/ventricles.tsv $(filter %.ventricles,$^)) > $@

$(NEURO)/volumes.tsv: $(patsubst %,$(NEURO)/%.labels.nii.gz,$(NEURO_PREDICTIONS) true) $(NEURO_SCRIPTS)/volumes.awk
	awk -f $(NEURO_SCRIPTS)/volumes.awk $(NEURO_INPUT)/labels.tsv $(patsubst %,$(NEURO)/%.labels.log,$(NEURO_PREDICTIONS) true) > $@

$(NEURO)/seconds.tsv: $(NEURO)/craniotomy.scan.nii.gz
	(printf 'stage\tseconds\n'; printf '%s\t%s\n' 'voxels and groups' "$$(cat $(NEURO)/predicted.body.seconds)" \
	    shapefn "$$(cat $(NEURO)/predicted.table.seconds)" mtled "$$(cat $(NEURO)/craniotomy.u.seconds)" \
	    warp "$$(cat $(NEURO)/craniotomy.scan.seconds)") > $@

# ---- pictures --------------------------------------------------------------------------------------------------------

# A slice through ventricles and tumour, every millimetre.
NEURO_SLICE := 18

$(NEURO)/slice.places: pipelines/neurosurgery.mk
	@mkdir -p $(@D)
	awk 'BEGIN { for (y = -110; y <= 80; y++) for (x = -80; x <= 80; x++) print x, y, $(NEURO_SLICE) }' > $@

$(NEURO)/before.slice: $(NEURO_SCAN) $(NEURO)/slice.places $(NEURO_PROGRAMS)
	sample -p $(NEURO)/slice.places -u mm $< > $@

$(NEURO)/craniotomy.slice $(NEURO)/true.slice: %.slice: %.scan.nii.gz $(NEURO)/slice.places $(NEURO_PROGRAMS)
	sample -p $(NEURO)/slice.places -u mm $< > $@

NEURO_CONTOUR = voxels -s z=$(NEURO_SLICE)mm -h 3mm -l $(NEURO_INPUT)/labels.tsv --surface ventricles -u mm $< > $@

$(NEURO)/before.contour: $(NEURO_LABELS) $(NEURO_INPUT)/labels.tsv $(NEURO_PROGRAMS)
	@mkdir -p $(@D)
	$(NEURO_CONTOUR)

$(NEURO)/craniotomy.contour $(NEURO)/true.contour: %.contour: %.labels.nii.gz $(NEURO_INPUT)/labels.tsv $(NEURO_PROGRAMS)
	$(NEURO_CONTOUR)

NEURO_PARTS := before craniotomy true

$(NEURO)/slices.plot: $(NEURO_PARTS:%=$(NEURO)/%.slice) $(NEURO_SCRIPTS)/slice.awk
	awk -f $(NEURO_SCRIPTS)/slice.awk $(filter %.slice,$^) > $@

# Every three millimetres within the brain.
$(NEURO)/distance.places: $(NEURO)/slice.places $(NEURO_LABELS) $(NEURO_PROGRAMS)
	sample -i nearest -p $< -u mm $(NEURO_LABELS) | awk '!/^#/ && $$4 > 0 && $$1 % 3 == 0 && $$2 % 3 == 0 { print $$1, $$2, $$3 }' > $@

$(NEURO)/%.distance: $(NEURO)/%.u.dat $(NEURO)/distance.places $(NEURO_PROGRAMS)
	interp -f u -p $(NEURO)/distance.places -u mm $< | mts print u - > $@

$(NEURO)/distance.plot: $(NEURO)/distance.places $(patsubst %,$(NEURO)/%.distance,true $(NEURO_PREDICTIONS))
	paste -d ' ' $^ | awk '\
	    { print $$1, $$2, 1e3 * sqrt(($$4 - $$7)^2 + ($$5 - $$8)^2 + ($$6 - $$9)^2), 1e3 * sqrt(($$4 - $$10)^2 + ($$5 - $$11)^2 + ($$6 - $$12)^2) }' > $@

$(NEURO)/slices.png: $(NEURO)/slices.plot $(NEURO)/distance.plot $(NEURO_PARTS:%=$(NEURO)/%.contour) $(NEURO_SCRIPTS)/slices.gp
	gnuplot -e "folder='$(NEURO)'; out='$@'" $(NEURO_SCRIPTS)/slices.gp
