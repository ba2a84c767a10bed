# make voxels: label images of known shapes, random blobs, an atlas and a head through voxels, and the compression of each body by a tenth
#
# A row for each image: nodes, cells, whether mts check finds fault, least and largest dihedral angle, the volume of the label that is
# farthest off, what is lost in thin parts, how far the nodes of interfaces are from them, seconds of the processor; then the
# compression's status, steps and least J, and from which share of the load on the body folds. Bodies of random blobs have crevices of some
# voxels, whose walls meet under the push: such a body is computed again, with contact with itself, and steps are those of that run. Then
# a ball and the whole brain, meshed by gmsh and from images: meshes.sh.
VOXELS_OUT := $(OUT)/voxels
VOXELS_SHAPES ?= sphere torus two four thin layer boxes atlas aniso flipped colin27 $(VOXELS_SEEDS:%=blobs-%)
VOXELS_SEEDS ?= 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20
VOXELS_PHANTOM := $(BUILD)/tests/helper/phantom
VOXELS_FILLED := $(BUILD)/pipelines/voxels/filled
VOXELS_TOOLS := $(addprefix $(BUILD)/bin/,voxels tag shapefn mtled mts)

# What voxels is told, where it is not a spacing of 5 mm.
voxels.options = -h 5mm
thin.options = -h 6mm --fine 1.5mm:label_2
layer.options = -h 2mm
atlas.options = -h 4mm -l pipelines/voxels/atlas.txt
colin27.options = -h 8mm --fine 4mm:label_2

.PHONY: voxels
voxels: $(VOXELS_OUT)/voxels.tsv $(VOXELS_OUT)/meshes.tsv
	@awk -F '\t' '{ printf "%-9s %6s %7s %5s %6s %6s %7s %7s %6s %4s %6s %6s %5s %7s %10s  %s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8, $$9, $$10, $$11, $$12, $$13, $$14, $$15, $$16 }' $<
	@awk -F '\t' 'NR > 1 { n++; good += $$4 == "yes" && $$5 >= 8 && $$6 <= 165; near += $$7 < 1 && $$7 > -1; ran += $$12 == 0; folds += $$15 != "-" } \
	    END { printf "\nof %d: valid, angles within 8 to 165 degrees: %d; volumes within 1 %%: %d; compressed: %d, of which fold: %d\n", n, good, near, ran, folds }' $<
	@echo
	@awk -F '\t' '{ printf "%-6s %-6s %14s %13s %8s %8s %14s %6s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8 }' $(VOXELS_OUT)/meshes.tsv

$(VOXELS_FILLED): $(VOXELS_FILLED).o $(LIBRARY)
	$(CC) $(LDFLAGS) -o $@ $^ $(LDLIBS)

# make check builds what only a study runs.
tested: $(VOXELS_FILLED)

$(VOXELS_OUT)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

$(VOXELS_OUT)/colin27.nii.gz: examples/neurosurgery/colin27_labels.nii.gz
	@mkdir -p $(@D)
	cp $< $@
$(VOXELS_OUT)/blobs-%.nii.gz: $(VOXELS_PHANTOM)
	@mkdir -p $(@D)
	$< blobs $* > $@
$(VOXELS_OUT)/aniso.nii.gz: $(VOXELS_PHANTOM)
	@mkdir -p $(@D)
	$< two 1 1,1.5,3 > $@
$(VOXELS_OUT)/flipped.nii.gz: $(VOXELS_PHANTOM)
	@mkdir -p $(@D)
	$< four@flipped 1 1,1,2 > $@
$(VOXELS_OUT)/%.nii.gz: $(VOXELS_PHANTOM)
	@mkdir -p $(@D)
	$< $* > $@

$(VOXELS_SHAPES:%=$(VOXELS_OUT)/%.row): $(VOXELS_OUT)/%.row: $(VOXELS_OUT)/%.nii.gz pipelines/voxels/row.sh pipelines/voxels/atlas.txt $(VOXELS_TOOLS)
	bash pipelines/voxels/row.sh $* $< $(or $($*.options),$(voxels.options)) > $@

$(VOXELS_OUT)/voxels.tsv: $(VOXELS_SHAPES:%=$(VOXELS_OUT)/%.row) pipelines/voxels.mk
	(printf 'image\tnodes\tcells\tvalid\tleast_angle\tlargest_angle\tvolume_error_percent\tlost_ml\tfarthest_voxels\tastray\tseconds\tstatus\tsteps\tleast_J\tfolds_from\tmessage\n'; \
	    awk -F '\t' -v OFS='\t' '{ from = "-"; if (match($$15, /folds from [0-9.]+/)) from = substr($$15, RSTART + 11, RLENGTH - 11); $$15 = from OFS $$15; print }' \
	    $(filter %.row,$^)) > $@

VOXELS_BODIES := ball brain
VOXELS_BRAIN3D := $(addprefix examples/brain3d/,brain3d.geo brain3d_surfaces.msh.gz brain3d_free.tsv.gz free.scene load.tsv)
$(VOXELS_BODIES:%=$(VOXELS_OUT)/meshes-%.tsv): $(VOXELS_OUT)/meshes-%.tsv: pipelines/voxels/meshes.sh pipelines/voxels/ball.geo \
        pipelines/voxels/ball.scene pipelines/voxels/surface.awk pipelines/reference.awk $(VOXELS_BRAIN3D) $(VOXELS_PHANTOM) $(VOXELS_FILLED) \
        $(addprefix $(BUILD)/bin/,nodes voxels tag mtled fieldcmp mts)
	@mkdir -p $(@D)
	bash $< $* $(VOXELS_PHANTOM) $(VOXELS_FILLED) > $@

$(VOXELS_OUT)/meshes.tsv: pipelines/voxels/meshes.awk $(VOXELS_BODIES:%=$(VOXELS_OUT)/meshes-%.tsv)
	awk -f $^ > $@
