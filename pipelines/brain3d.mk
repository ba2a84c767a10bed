# make brain3d: the whole brain by several schemes and mixed elements (FreeFEM) without the skull, and by the default in it
#
# make brain3d-fine adds the default on 61 700 nodes: half an hour.
# Everything lies in build/out/brain3d. A scheme S has S.dat (the displacements, a text stream), S.log (what the tools
# report), S.errors (its distance from the reference), S.row (its line of compare.tsv) and S.balance (that of balance.tsv).

BRAIN3D := $(OUT)/brain3d
BRAIN3D_INPUT := examples/brain3d
BRAIN3D_TABLES := $(BRAIN3D_INPUT)/load.tsv $(BRAIN3D_INPUT)/skull.tsv
BRAIN3D_AT_NODES := mls1-at-nodes mmls-at-nodes
BRAIN3D_FREE := $(BRAIN3D_AT_NODES) small-free mixed-free
BRAIN3D_COMPARED := $(BRAIN3D_FREE) large-free small
# More meshes of the sizes of small and large: gmsh makes others of sizes that hardly differ.
BRAIN3D_SMALL := small small-2 small-3
BRAIN3D_LARGE := large large-2 large-3
BRAIN3D_MIXED := mixed mixed-2 mixed-3

# What each is called in compare.tsv.
mls1-at-nodes.name := linear MLS, 4 points, k = 1.4, conditions at nodes, pointwise volume
mmls-at-nodes.name := MMLS, 4 points, k = 1.8, conditions at nodes, pointwise volume
small-free.name := MMLS, smoothed cells, nodal volume, boundary averages (default)
mixed-free.name := mixed elements (FreeFEM), same tetrahedra
large-free.name := the default on a finer mesh
small.name := sliding on the skull: default
large.name := sliding on the skull: the default on a finer mesh (reference)

.PHONY: brain3d brain3d-fine
brain3d: $(BRAIN3D)/compare.tsv $(BRAIN3D)/balance.tsv $(BRAIN3D)/meshes.tsv $(BRAIN3D)/brain3d.png $(BRAIN3D)/brain3d.vtu
	@awk -F '\t' '{ printf "%-74s %6s %6s %8s %8s %6s %8s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7 }' $<
	@echo
	@awk -F '\t' '{ printf "%-74s %8s %7s %7s %9s %9s %9s %9s %7s %8s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8, $$9, $$10 }' \
	    $(BRAIN3D)/balance.tsv
	@echo
	@awk -F '\t' '{ printf "%-74s %16s %8s %9s %8s %7s\n", $$1, $$2, $$3, $$4, $$5, $$6 }' $(BRAIN3D)/meshes.tsv
	$(PICTURES)

$(BRAIN3D)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

# ---- mesh ------------------------------------------------------------------------------------------------------------

$(BRAIN3D)/small.msh: BRAIN3D_SIZE := 13.8
$(BRAIN3D)/small-2.msh: BRAIN3D_SIZE := 13.7
$(BRAIN3D)/small-3.msh: BRAIN3D_SIZE := 13.9
$(BRAIN3D)/large.msh: BRAIN3D_SIZE := 6.2
$(BRAIN3D)/large-2.msh: BRAIN3D_SIZE := 6.15
$(BRAIN3D)/large-3.msh: BRAIN3D_SIZE := 6.25
$(BRAIN3D)/fine.msh: BRAIN3D_SIZE := 3.7

$(BRAIN3D)/brain3d_surfaces.msh: $(BRAIN3D_INPUT)/brain3d_surfaces.msh.gz
	@mkdir -p $(@D)
	gzip -dc $< > $@

# The geometry merges the surfaces beside it.
$(BRAIN3D)/brain3d.geo: $(BRAIN3D_INPUT)/brain3d.geo
	@mkdir -p $(@D)
	cp $< $@

$(addprefix $(BRAIN3D)/,$(addsuffix .msh,$(BRAIN3D_SMALL) $(BRAIN3D_LARGE) fine)): $(BRAIN3D)/brain3d.geo $(BRAIN3D)/brain3d_surfaces.msh
	gmsh -3 -nt 1 -v 2 $< -setnumber lc $(BRAIN3D_SIZE) -o $@

# The cloud is renewed only when it changes, so that a rebuilt tool does not call for a new solution by mixed elements.
$(BRAIN3D_SMALL:%=$(BRAIN3D)/%.made): $(BRAIN3D)/%.made: $(BRAIN3D)/%.msh $(BUILD)/bin/nodes
	nodes -u mm -t $< > $(@:.made=.new)
	cmp -s $(@:.made=.new) $(@:.made=.cloud.dat) || cp $(@:.made=.new) $(@:.made=.cloud.dat)
	rm $(@:.made=.new)
	touch $@

$(BRAIN3D_SMALL:%=$(BRAIN3D)/%.cloud.dat): $(BRAIN3D)/%.cloud.dat: $(BRAIN3D)/%.made ;

# ---- solutions -------------------------------------------------------------------------------------------------------

BRAIN3D_PROGRAMS := $(addprefix $(BUILD)/bin/,nodes ipoints support shapefn mtled)

# What is said on standard error goes to S.log, and is shown when the command fails.
BRAIN3D_LOG = 2> $(@:.dat=.log) || { cat $(@:.dat=.log) >&2; false; }

$(BRAIN3D)/%-free.dat: BRAIN3D_SCENE := $(BRAIN3D_INPUT)/free.scene
BRAIN3D_SCENE := $(BRAIN3D_INPUT)/brain3d.scene

define BRAIN3D_SOLVE
(nodes -u mm $< | ipoints | support -v | shapefn | mtled -v $(BRAIN3D_SCENE)) > $@ $(BRAIN3D_LOG)
endef

$(BRAIN3D)/small.dat $(BRAIN3D)/large.dat $(BRAIN3D)/fine.dat: $(BRAIN3D)/%.dat: $(BRAIN3D)/%.msh \
        $(BRAIN3D_INPUT)/brain3d.scene $(BRAIN3D_TABLES) $(BRAIN3D_PROGRAMS)
	$(BRAIN3D_SOLVE)

$(addprefix $(BRAIN3D)/,$(addsuffix -free.dat,$(BRAIN3D_SMALL) $(BRAIN3D_LARGE))): $(BRAIN3D)/%-free.dat: $(BRAIN3D)/%.msh \
        $(BRAIN3D_INPUT)/free.scene $(BRAIN3D_TABLES) $(BRAIN3D_PROGRAMS)
	$(BRAIN3D_SOLVE)

# The paper's schemes, with local radii as these clouds are graded: four points per tetrahedron, conditions at the nodes.
mls1-at-nodes.support := --reach distance -k 1.4 -b mls1
mmls-at-nodes.support := --reach distance -k 1.8 -b mmls2

$(BRAIN3D_AT_NODES:%=$(BRAIN3D)/%.dat): $(BRAIN3D)/%.dat: $(BRAIN3D)/small.msh $(BRAIN3D_INPUT)/paper.scene \
        $(BRAIN3D_TABLES) $(BRAIN3D_PROGRAMS)
	(nodes -u mm $< | ipoints -g 4 | support -v $($*.support) | shapefn | \
	    mtled -v $(BRAIN3D_INPUT)/paper.scene) > $@ $(BRAIN3D_LOG)

$(BRAIN3D_MIXED:%=$(BRAIN3D)/%-free.dat): $(BRAIN3D)/mixed%-free.dat: $(BRAIN3D_INPUT)/free.scene $(BRAIN3D)/small%.cloud.dat $(BRAIN3D_TABLES) $(wildcard pipelines/mixed/*) \
        $(addprefix pipelines/,stream.awk scene.awk table.awk)
	bash pipelines/mixed/solve.sh $(wordlist 1,2,$^) > $@ $(BRAIN3D_LOG)

# ---- comparison ------------------------------------------------------------------------------------------------------

# Without the skull each against the reference; with it the default against the default on a finer mesh.
$(BRAIN3D)/reference.dat: $(BRAIN3D_INPUT)/brain3d_free.tsv.gz pipelines/reference.awk
	@mkdir -p $(@D)
	gzip -dc $< | awk -f pipelines/reference.awk > $@

$(BRAIN3D)/%-free.errors $(BRAIN3D)/%-at-nodes.errors: BRAIN3D_REFERENCE := reference
$(BRAIN3D)/small.errors: BRAIN3D_REFERENCE := large
$(BRAIN3D_COMPARED:%=$(BRAIN3D)/%.errors): $(BRAIN3D)/%.errors: $(BRAIN3D)/%.dat $(BRAIN3D)/reference.dat $(BUILD)/bin/fieldcmp
$(BRAIN3D)/small.errors: $(BRAIN3D)/large.dat
$(BRAIN3D_COMPARED:%=$(BRAIN3D)/%.errors):
	fieldcmp $< $(BRAIN3D)/$(BRAIN3D_REFERENCE).dat > $@

BRAIN3D_ROWS := $(BRAIN3D_COMPARED) large

$(BRAIN3D_ROWS:%=$(BRAIN3D)/%.row): $(BRAIN3D)/%.row: $(BRAIN3D)/%.dat pipelines/row.awk
	awk -f pipelines/row.awk -v scheme='$($*.name)' -v field=$< $(@:.row=.log) $(filter %.errors,$^) > $@
$(BRAIN3D_COMPARED:%=$(BRAIN3D)/%.row): $(BRAIN3D)/%.row: $(BRAIN3D)/%.errors

# The body hangs on its craniotomy alone and turns about it: one mesh tells little.
BRAIN3D_ALL_FREE := $(addsuffix -free,$(BRAIN3D_SMALL) $(BRAIN3D_MIXED) $(BRAIN3D_LARGE))
BRAIN3D_MORE_FREE := $(filter-out small-free mixed-free large-free,$(BRAIN3D_ALL_FREE))
$(BRAIN3D_MORE_FREE:%=$(BRAIN3D)/%.errors): $(BRAIN3D)/%.errors: $(BRAIN3D)/%.dat $(BRAIN3D)/reference.dat $(BUILD)/bin/fieldcmp
	fieldcmp $< $(BRAIN3D)/reference.dat > $@
$(BRAIN3D_MORE_FREE:%=$(BRAIN3D)/%.row): $(BRAIN3D)/%.row: $(BRAIN3D)/%.dat $(BRAIN3D)/%.errors pipelines/row.awk
	awk -f pipelines/row.awk -v scheme=$* -v field=$< $(@:.row=.log) $(@:.row=.errors) > $@

$(BRAIN3D)/meshes.tsv: pipelines/brain3d/meshes.awk $(BRAIN3D_ALL_FREE:%=$(BRAIN3D)/%.row)
	awk -f $< -v names='$(small-free.name)	$(mixed-free.name)	$(large-free.name)' $(wordlist 2,99,$^) > $@

$(BRAIN3D)/compare.tsv: $(BRAIN3D_ROWS:%=$(BRAIN3D)/%.row) pipelines/brain3d.mk
	(printf 'scheme\tnodes\tpoints\tavg_mm\tmax_mm\tsteps\tseconds\n'; cat $(filter %.row,$^)) > $@

$(BRAIN3D_ROWS:%=$(BRAIN3D)/%.balance): $(BRAIN3D)/%.balance: $(BRAIN3D)/%.dat pipelines/brain3d/balance.awk
	awk -f pipelines/stream.awk -f pipelines/brain3d/balance.awk -v scheme='$($*.name)' -v field=$< \
	    -v report=$(@:.balance=.log) > $@

$(BRAIN3D)/balance.tsv: $(BRAIN3D_ROWS:%=$(BRAIN3D)/%.balance) pipelines/brain3d.mk
	(printf 'scheme\tpairs\tleast_J\tmost_J\tpressed_N\tskull_N\tmissing_N\tdeepest_mm\ttouching\tof\n'; \
	    cat $(filter %.balance,$^)) > $@

# ---- finer -----------------------------------------------------------------------------------------------------------

brain3d-fine: $(BRAIN3D)/small.dat $(BRAIN3D)/large.dat $(BRAIN3D)/fine.dat $(BUILD)/bin/fieldcmp
	@grep -E '^(points|pairs|steps|least J|solve seconds)' $(BRAIN3D)/fine.log
	@for coarser in small large; do \
	    echo "$$coarser - fine, m:"; PATH=$(abspath $(BUILD))/bin:$$PATH fieldcmp $(BRAIN3D)/$$coarser.dat $(BRAIN3D)/fine.dat | grep -E '^(avg|max)'; \
	done

# ---- pictures --------------------------------------------------------------------------------------------------------

$(BRAIN3D)/brain3d.vtu: $(BRAIN3D)/large.dat $(BUILD)/bin/tovtk
	tovtk -o $@ $<

$(BRAIN3D)/brain3d.png: $(BRAIN3D)/large.dat $(BRAIN3D_INPUT)/skull.tsv pipelines/render.py
	pipelines/render.py --most 10 --view=0.9798,0.1591,0.1212 --rim craniotomy --title 'seen from the craniotomy, its rim in black' \
	    --cut=0,0,1,20 --cut-title 'z = 20 mm, from above; black: skull' --rigid $(BRAIN3D_INPUT)/skull.tsv $< $@
