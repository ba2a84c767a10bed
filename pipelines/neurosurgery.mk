# make neurosurgery: brain shift from a label image to a warped scan (Colin27): a craniotomy, a resection with drainage, electrodes
#
# Everything lies in build/out/neurosurgery, and in resection and electrodes there: neurosurgery.tsv (errors before and after), seconds.tsv, a
# picture; of the craniotomy volumes.tsv, rounds.tsv (how the load was found) and a film of the shift as well. The scan is that of Debian's mricron-data; where it is not installed the label image stands
# in for it. One of them alone: make neurosurgery-one NEURO_SCENARIO=resection.
NEURO_SCENARIO ?= craniotomy
NEURO := $(OUT)/neurosurgery$(patsubst %,/%,$(filter-out craniotomy,$(NEURO_SCENARIO)))
NEURO_INPUT := examples/neurosurgery
NEURO_LABELS := $(NEURO_INPUT)/colin27_labels.nii.gz
NEURO_SCAN ?= $(firstword $(wildcard /usr/share/mricron/templates/ch2.nii.gz) $(NEURO_LABELS))
NEURO_SCRIPTS := pipelines/neurosurgery
# Spacing of the nodes of the prediction and of the true state.
NEURO_SPACING ?= 9mm
NEURO_TRUE_SPACING ?= 7mm
# That of the nodes with which loads are found.
NEURO_LOAD_SPACING ?= 12mm
NEURO_RANDOM := awk -f $(NEURO_SCRIPTS)/random.awk
NEURO_TIMED := bash $(NEURO_SCRIPTS)/timed.sh
NEURO_PROGRAMS := $(addprefix $(BUILD)/bin/,voxels tag shapefn mtled interp sample warp mts)
NEURO_LOG = 2> $(@:.dat=.log) || { cat $(@:.dat=.log) >&2; false; }

# What differs: the names of the labels, the part of the surface that is seen, names of others, labels that landmarks lie in, the true scene, what is predicted: from what is
# seen alone, with the weight that is found from it, and knowing how the patient lies.
NEURO_STEM := -u mm -f 'stem=ball:0,-41,-65,12'
NEURO_EXPOSED := -f 'exposed=parenchyma|outside and ball:63.5,16,20,33'
ifeq ($(NEURO_SCENARIO),craniotomy)
NEURO_NAMES := $(NEURO_INPUT)/labels.tsv
NEURO_GROUPS := $(NEURO_STEM) $(NEURO_EXPOSED) -f 'cortex=all without stem without exposed'
NEURO_INSIDE := $$4 > 0
NEURO_TRUTH := truth
NEURO_PREDICTIONS := craniotomy load position
NEURO_COLUMNS := from_cortex\tload_found\twith_gravity
NEURO_DEVIATION := -d 0.5
NEURO_SEEN := from the exposed cortex
else ifeq ($(NEURO_SCENARIO),resection)
NEURO_NAMES := $(NEURO_INPUT)/resection.tsv
NEURO_GROUPS := $(NEURO_STEM) $(NEURO_EXPOSED) -f 'cortex=parenchyma|outside without stem without exposed'
NEURO_INSIDE := $$4 > 0 && $$4 < 3
NEURO_MEASURED := -v 'groups=exposed,parenchyma|tumour' -v deviation=0.5
else ifeq ($(NEURO_SCENARIO),electrodes)
NEURO_NAMES := $(NEURO_INPUT)/electrodes.tsv
NEURO_GROUPS := $(NEURO_STEM) -f 'cortex=parenchyma|outside without stem'
NEURO_INSIDE := $$4 > 0
else
$(error NEURO_SCENARIO: $(NEURO_SCENARIO) is none of craniotomy, resection, electrodes)
endif
NEURO_TRUTH ?= $(NEURO_SCENARIO)_truth
NEURO_PREDICTIONS ?= $(NEURO_SCENARIO) $(NEURO_SCENARIO)_load $(NEURO_SCENARIO)_position
NEURO_COLUMNS ?= from_points\tload_found\twith_gravity
NEURO_SEEN ?= from points
NEURO_FIRST := $(firstword $(NEURO_PREDICTIONS))
NEURO_FOUND := $(word 2,$(NEURO_PREDICTIONS))

.PHONY: neurosurgery neurosurgery-one
neurosurgery: neurosurgery-one
	@$(MAKE) --no-print-directory neurosurgery-one NEURO_SCENARIO=resection
	@$(MAKE) --no-print-directory neurosurgery-one NEURO_SCENARIO=electrodes

neurosurgery-one: $(addprefix $(NEURO)/,neurosurgery.tsv seconds.tsv slices.png) $(if $(filter craniotomy,$(NEURO_SCENARIO)),$(addprefix $(NEURO)/,volumes.tsv rounds.tsv shift.gif))
	@echo
	@echo '$(NEURO_SCENARIO)'
	@awk -F '\t' '{ printf "%-56s %12s %12s %12s %12s\n", $$1, $$2, $$3, $$4, $$5 }' $<
	@[ ! -f $(NEURO)/volumes.tsv ] || { echo; awk -F '\t' '{ printf "%-18s %12s %12s %12s %12s %12s\n", $$1, $$2, $$3, $$4, $$5, $$6 }' $(NEURO)/volumes.tsv; }
	@echo
	@awk -F '\t' '{ printf "%-18s %12s\n", $$1, $$2 }' $(NEURO)/seconds.tsv
	$(PICTURES)

$(NEURO)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

# ---- the true state, and what is measured of it ----------------------------------------------------------------------

$(NEURO)/%.scene: $(NEURO_INPUT)/%.scene
	@mkdir -p $(@D)
	cp $< $@

$(NEURO)/skull.tsv: $(NEURO_LABELS) $(NEURO_INPUT)/brain.tsv $(NEURO_PROGRAMS)
	@mkdir -p $(@D)
	voxels $< -h 5mm -l $(NEURO_INPUT)/brain.tsv --surface 'brain|outside' --gap 2mm > $@

$(NEURO)/true.u.dat: $(NEURO_LABELS) $(NEURO_NAMES) $(NEURO)/$(NEURO_TRUTH).scene $(NEURO)/skull.tsv $(NEURO_PROGRAMS)
	(voxels $< -h $(NEURO_TRUE_SPACING) -l $(NEURO_NAMES) | tag $(NEURO_GROUPS) | shapefn | \
	    mtled -v $(NEURO)/$(NEURO_TRUTH).scene) > $@ $(NEURO_LOG)

ifeq ($(NEURO_SCENARIO),electrodes)
# Contacts of twelve electrodes that lie in the brain.
$(NEURO)/measured.tsv: $(NEURO)/true.u.dat $(NEURO_LABELS) $(NEURO_SCRIPTS)/electrodes.awk $(NEURO_SCRIPTS)/noisy.awk $(NEURO_SCRIPTS)/random.awk $(NEURO_PROGRAMS)
	awk -f $(NEURO_SCRIPTS)/electrodes.awk > $(@:.tsv=.all)
	sample -i nearest -p $(@:.tsv=.all) -u mm $(NEURO_LABELS) | awk '!/^#/ && ($(NEURO_INSIDE)) && n < 200 { n++; print $$1, $$2, $$3 }' > $(@:.tsv=.places)
	interp -f u -p $(@:.tsv=.places) -u mm $< | mts print u - > $(@:.tsv=.moved)
	$(NEURO_RANDOM) -f $(NEURO_SCRIPTS)/noisy.awk -v noise=0.5 $(@:.tsv=.places) $(@:.tsv=.moved) > $@
else
$(NEURO)/measured.tsv: $(NEURO)/true.u.dat $(NEURO_SCRIPTS)/measured.awk $(NEURO_SCRIPTS)/random.awk pipelines/stream.awk
	$(NEURO_RANDOM) -f pipelines/stream.awk -f $(NEURO_SCRIPTS)/measured.awk -v field=$< -v points=200 -v noise=0.5 \
	    $(NEURO_MEASURED) > $@
endif

# ---- prediction ------------------------------------------------------------------------------------------------------

# Less noise: moving least squares, linear, over 15 mm.
$(NEURO)/exposed.tsv: $(NEURO)/measured.tsv $(NEURO_SCRIPTS)/points.awk $(NEURO_PROGRAMS)
	grep -v '^#' $< | cut -f 1-3 > $(@:.tsv=.places)
	awk -f $(NEURO_SCRIPTS)/points.awk $< | interp -f u -p $(@:.tsv=.places) -u mm -b mls1 -R 15mm > $(@:.tsv=.smooth)
	paste $(@:.tsv=.places) <(mts print u $(@:.tsv=.smooth) | awk '{ print 1e3 * $$1, 1e3 * $$2, 1e3 * $$3 }') > $@

$(NEURO)/predicted.body.mts $(NEURO)/coarse.body.mts: $(NEURO_LABELS) $(NEURO_NAMES) $(NEURO_PROGRAMS)
	@mkdir -p $(@D)
	$(NEURO_TIMED) $(@:.mts=.seconds) "voxels $< -h $(if $(filter coarse.%,$(@F)),$(NEURO_LOAD_SPACING),$(NEURO_SPACING)) \
	    -l $(NEURO_NAMES) | tag $(NEURO_GROUPS) > $@"

$(NEURO)/%.table.mts: $(NEURO)/%.body.mts $(NEURO_PROGRAMS)
	$(NEURO_TIMED) $(@:.mts=.seconds) "shapefn $< > $@"

# The weight, in size and direction, that moves the measured points as they moved: on a coarser cloud.
$(NEURO)/load.template: $(NEURO_INPUT)/$(NEURO_FIRST).scene $(NEURO_SCRIPTS)/load.awk
	@mkdir -p $(@D)
	awk -f $(NEURO_SCRIPTS)/load.awk $< > $@

$(NEURO)/found/identified.tsv: $(NEURO_INPUT)/gravity.tsv $(NEURO)/load.template $(NEURO)/coarse.table.mts $(NEURO)/measured.tsv $(NEURO)/skull.tsv \
        $(wildcard pipelines/identify/*) $(NEURO_PROGRAMS)
	$(NEURO_TIMED) $(NEURO)/found.seconds "bash pipelines/identify/identify.sh -j 2 -u mm $(NEURO_DEVIATION) $(wordlist 1,4,$^) $(@D) > $(NEURO)/found.log"

$(NEURO)/rounds.tsv: $(NEURO)/found/identified.tsv
	awk '{ line = ""; for (i = 2; i <= NF; i += 2) line = line (i > 2 ? "\t" : "") $$i } \
	    NR == 1 { print "round\tmisfit\tgx\tgy\tgz" } { print line }' $(NEURO)/found.log > $@

$(NEURO)/$(NEURO_FOUND).scene: $(NEURO_INPUT)/$(NEURO_FIRST).scene $(NEURO)/found/identified.tsv $(NEURO_SCRIPTS)/load.awk
	awk -f $(NEURO_SCRIPTS)/load.awk -v found=$(word 2,$^) $< > $@

$(NEURO_PREDICTIONS:%=$(NEURO)/%.u.dat): %.u.dat: $(NEURO)/predicted.table.mts %.scene $(NEURO)/$(if $(filter craniotomy,$(NEURO_SCENARIO)),exposed,measured).tsv $(NEURO)/skull.tsv $(NEURO_PROGRAMS)
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
	sample -i nearest -p $(@:.tsv=.places) -u mm $< | awk '!/^#/ && $(NEURO_INSIDE) && n < 50 { n++; print $$1, $$2, $$3 }' > $@

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
	(printf 'distance from the true state\tunpredicted\t$(NEURO_COLUMNS)\n'; awk -f $(NEURO_SCRIPTS)/target.awk $(filter %.landmarks,$^); \
	    awk -f $(NEURO_SCRIPTS)/surface.awk -v triangles=$(NEURO)/ventricles.tsv $(filter %.ventricles,$^)) > $@

# The voxels of each label, of 1 mm, by a byte each.
NEURO_VOLUMES = gzip -dc $< | od -An -v -j 352 -t u1 -w4096 | awk '{ for (i = 1; i <= NF; i++) n[$$i]++ } END { for (l in n) print l, n[l] / 1000 }' > $@

$(NEURO)/before.volumes: $(NEURO_LABELS)
	$(NEURO_VOLUMES)

$(patsubst %,$(NEURO)/%.volumes,$(NEURO_PREDICTIONS) true): %.volumes: %.labels.nii.gz
	$(NEURO_VOLUMES)

$(NEURO)/volumes.tsv: $(NEURO_SCRIPTS)/volumes.awk $(NEURO_INPUT)/labels.tsv $(patsubst %,$(NEURO)/%.volumes,before $(NEURO_PREDICTIONS) true)
	awk -v titles='$(NEURO_COLUMNS)' -f $^ > $@

$(NEURO)/seconds.tsv: $(NEURO)/$(NEURO_FOUND).scan.nii.gz
	(printf 'stage\tseconds\n'; printf '%s\t%s\n' 'voxels and tag' "$$(cat $(NEURO)/predicted.body.seconds)" \
	    shapefn "$$(cat $(NEURO)/predicted.table.seconds)" 'identify.sh (load_found)' "$$(cat $(NEURO)/found.seconds)" \
	    mtled "$$(cat $(NEURO)/$(NEURO_FOUND).u.seconds)" warp "$$(cat $(NEURO)/$(NEURO_FOUND).scan.seconds)") > $@

# ---- pictures --------------------------------------------------------------------------------------------------------

# A slice through ventricles and tumour, every millimetre.
NEURO_SLICE := 18

$(NEURO)/slice.places: pipelines/neurosurgery.mk
	@mkdir -p $(@D)
	awk 'BEGIN { for (y = -110; y <= 80; y++) for (x = -80; x <= 80; x++) print x, y, $(NEURO_SLICE) }' > $@

$(NEURO)/before.slice: $(NEURO_SCAN) $(NEURO)/slice.places $(NEURO_PROGRAMS)
	sample -p $(NEURO)/slice.places -u mm $< > $@

$(NEURO)/$(NEURO_FOUND).slice $(NEURO)/true.slice: %.slice: %.scan.nii.gz $(NEURO)/slice.places $(NEURO_PROGRAMS)
	sample -p $(NEURO)/slice.places -u mm $< > $@

NEURO_CONTOUR = voxels -s z=$(NEURO_SLICE)mm -h 3mm -l $(NEURO_INPUT)/labels.tsv --surface ventricles -u mm $< > $@

$(NEURO)/before.contour: $(NEURO_LABELS) $(NEURO_INPUT)/labels.tsv $(NEURO_PROGRAMS)
	@mkdir -p $(@D)
	$(NEURO_CONTOUR)

$(NEURO)/$(NEURO_FOUND).contour $(NEURO)/true.contour: %.contour: %.labels.nii.gz $(NEURO_INPUT)/labels.tsv $(NEURO_PROGRAMS)
	$(NEURO_CONTOUR)

NEURO_PARTS := before $(NEURO_FOUND) true

$(NEURO)/slices.plot: $(NEURO_PARTS:%=$(NEURO)/%.slice) $(NEURO_SCRIPTS)/slice.awk
	awk -f $(NEURO_SCRIPTS)/slice.awk $(filter %.slice,$^) > $@

# Every three millimetres within the brain.
$(NEURO)/distance.places: $(NEURO)/slice.places $(NEURO_LABELS) $(NEURO_PROGRAMS)
	sample -i nearest -p $< -u mm $(NEURO_LABELS) | awk '!/^#/ && $(NEURO_INSIDE) && $$1 % 3 == 0 && $$2 % 3 == 0 { print $$1, $$2, $$3 }' > $@

$(NEURO)/%.distance: $(NEURO)/%.u.dat $(NEURO)/distance.places $(NEURO_PROGRAMS)
	interp -f u -p $(NEURO)/distance.places -u mm $< | mts print u - > $@

$(NEURO)/distance.plot: $(NEURO)/distance.places $(patsubst %,$(NEURO)/%.distance,true $(NEURO_FIRST) $(NEURO_FOUND))
	paste -d ' ' $^ | awk '\
	    { print $$1, $$2, 1e3 * sqrt(($$4 - $$7)^2 + ($$5 - $$8)^2 + ($$6 - $$9)^2), 1e3 * sqrt(($$4 - $$10)^2 + ($$5 - $$11)^2 + ($$6 - $$12)^2) }' > $@

$(NEURO)/slices.png: $(NEURO)/slices.plot $(NEURO)/distance.plot $(NEURO_PARTS:%=$(NEURO)/%.contour) $(NEURO_SCRIPTS)/slices.gp
	gnuplot -e "folder='$(NEURO)'; out='$@'; prediction='$(NEURO_FOUND)'; seen='$(NEURO_SEEN)'" $(NEURO_SCRIPTS)/slices.gp

# The shift on the way: states of equilibrium at shares of the load.
NEURO_FRAMES := 0 1 2 3 4 5

$(NEURO)/shift.scene: $(NEURO)/load.scene
	@mkdir -p $(@D)
	(cat $<; printf '\n[output]\nframes = $(lastword $(NEURO_FRAMES))\n') > $@

$(NEURO)/shift.u.dat: $(NEURO)/predicted.table.mts $(NEURO)/shift.scene $(NEURO)/exposed.tsv $(NEURO)/skull.tsv $(NEURO_PROGRAMS)
	mtled -v $(NEURO)/shift.scene $< > $@ $(NEURO_LOG)

$(NEURO_FRAMES:%=$(NEURO)/shift-%.slice): $(NEURO)/shift-%.slice: $(NEURO)/shift.u.dat $(NEURO_SCAN) $(NEURO)/slice.places
	warp --frame $* --vacated 0 -o $(@:.slice=.nii) $(NEURO_SCAN) $<
	sample -p $(NEURO)/slice.places -u mm $(@:.slice=.nii) > $@
	rm $(@:.slice=.nii)

$(NEURO)/shift.gif: $(NEURO_FRAMES:%=$(NEURO)/shift-%.slice) $(NEURO)/before.contour $(NEURO_SCRIPTS)/shift.gp
	for k in $(NEURO_FRAMES); do awk '/^#/ || NF < 4 { next } $$2 != last && NR > 1 { print "" } { last = $$2; print $$1, $$2, $$4 }' \
	    $(NEURO)/shift-$$k.slice > $(NEURO)/shift-$$k.plot; done
	gnuplot -e "folder='$(NEURO)'; out='$@'; last=$(lastword $(NEURO_FRAMES))" $(NEURO_SCRIPTS)/shift.gp
