# Not a study: a scene of your own on meshes that are refined where it must be, until its error is estimated to be below a tolerance:
#
#   make refine SCENE=examples/block/block.scene GEO=examples/block/block.geo UNIT=mm TOL=0.01mm NODES=20000
#   make refine SCENE=mine.scene GEO=labels.nii.gz SPACING=8mm VOXELS='-l labels.tsv' TOL=0.1mm
#   make refine SCENE=mine.scene GEO=mine.geo UNIT=mm GROUPS="-u mm -f 'held=low:z,5'" SUPPORT='-k 2' ROUNDS=4 TOL=0.1mm
#
# UNIT is that of the geometry, which is no image; NODES and ROUNDS are how many there may be; GROUPS, SUPPORT and, of an image, VOXELS
# are arguments of these stages, and SPACING is that of the first lattice.
# pipelines/refine/refine.sh tells of each round and of what stays in REFINE_OUT.
REFINE_OUT = $(OUT)/refine/$(basename $(notdir $(SCENE)))

.PHONY: refine
refine: export PATH := $(abspath $(BUILD))/bin:$(PATH)
refine: export REFINE_GROUPS = $(GROUPS)
refine: $(addprefix $(BUILD)/bin/,nodes voxels tag ipoints support shapefn mtled mts fielderr sizefield)
	@bash pipelines/refine/refine.sh '$(SCENE)' '$(GEO)' '$(TOL)' '$(REFINE_OUT)'
