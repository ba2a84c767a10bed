# make foreign: meshes as other programs make them (voxels, slivers, surfaces meshed anew, bodies with a gap, slender ones), fixed at one end and compressed by 12 %
#
# None has named parts of the boundary: tag makes them. A row for each mesh, whatever comes of it; at the end the share
# that ran by default within 3 000 steps. Lips and bodies that the push presses into each other are pulled by as much in a row of
# their own. FOREIGN_SECONDS bounds each run. Times are of one thread.
FOREIGN := $(OUT)/foreign
FOREIGN_SECONDS ?= 200
FOREIGN_MESHES := cylinder graded ring second-order cup slit cavity stl-volume voxels-hex voxels-tet delaunay-1 delaunay-2 \
    delaunay-3 squeezed jittered-1 jittered-2 jittered-3 gap-beside gap-behind coincident brain rod taper pin tube arch portal ladder channel cruciform fins \
    comb
FOREIGN_PULLED := slit gap-beside coincident
FOREIGN_TOOLS := $(addprefix $(BUILD)/bin/,nodes tag shapefn mtled mts)

.PHONY: foreign
foreign: $(FOREIGN)/foreign.tsv
	@awk -F '\t' '{ printf "%-17s %6s %6s %8s %6s %6s %8s %8s  %s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8, $$9 }' $<
	@awk -F '\t' 'NR > 1 { n++; good = $$5 == 0 && $$6 <= 3000; told = ($$5 == 1 || $$5 == 2) && $$9 ~ /^[a-z]+: /; ran += good; refused += told; \
	        if (!good && !told) rest = rest " " $$1 } \
	    END { printf "\nran by default within 3 000 steps: %d of %d (%.0f %%); refused with the place and the remedy: %d; neither:%s\n", \
	        ran, n, 100 * ran / n, refused, rest == "" ? " none" : rest }' $<

$(FOREIGN)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

$(FOREIGN_MESHES:%=$(FOREIGN)/%.msh): $(FOREIGN)/%.msh: pipelines/foreign/mesh.sh pipelines/foreign/jitter.awk
	@mkdir -p $(@D)
	bash $< $* $@

$(FOREIGN_MESHES:%=$(FOREIGN)/%.row): $(FOREIGN)/%.row: $(FOREIGN)/%.msh pipelines/foreign/push.sh $(FOREIGN_TOOLS)
	bash pipelines/foreign/push.sh $* $< $(FOREIGN_SECONDS) > $@

$(FOREIGN_PULLED:%=$(FOREIGN)/%-pulled.row): $(FOREIGN)/%-pulled.row: $(FOREIGN)/%.msh pipelines/foreign/push.sh $(FOREIGN_TOOLS)
	bash pipelines/foreign/push.sh $*-pulled $< $(FOREIGN_SECONDS) > $@

$(FOREIGN)/foreign.tsv: $(FOREIGN_MESHES:%=$(FOREIGN)/%.row) $(FOREIGN_PULLED:%=$(FOREIGN)/%-pulled.row) pipelines/foreign.mk
	(printf 'mesh\tnodes\tcells\tquality\tstatus\tsteps\tseconds\tleast_J\tmessage\n'; cat $(filter %.row,$^)) > $@
