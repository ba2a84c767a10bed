# Not a study: a scene of your own on meshes that are refined where it must be, until its error is estimated to be below a tolerance:
#
#   make refine SCENE=examples/block/block.scene GEO=examples/block/block.geo UNIT=mm TOL=0.01mm NODES=20000
#   make refine SCENE=mine.scene GEO=labels.nii.gz SPACING=8mm VOXELS='-l labels.tsv' TOL=0.1mm
#
# pipelines/refine/refine.sh tells of each round and of what stays in REFINE_OUT.
REFINE_OUT = $(OUT)/refine/$(basename $(notdir $(SCENE)))

.PHONY: refine
refine: export PATH := $(abspath $(BUILD))/bin:$(PATH)
refine: $(addprefix $(BUILD)/bin/,nodes voxels ipoints support shapefn mtled mts fielderr sizefield)
	@bash pipelines/refine/refine.sh '$(SCENE)' '$(GEO)' '$(TOL)' '$(REFINE_OUT)'
