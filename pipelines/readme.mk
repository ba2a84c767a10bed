# Not a study: the results of the studies that have been run go to pipelines/results, and README.md, examples/README.md and
# pipelines/README.md are made afresh: with these figures, and with what the commands in them print now
# (`make brain2d table1 readme`, for example). Pictures are made small by ImageMagick, and left as they are where there is none.

README_TEXTS := README.md examples/README.md examples/neurosurgery/README.md pipelines/README.md
README_PICTURES := brain2d/section brain2d/difference table1/surface speed-error/speed-error brain3d/brain3d convergence/convergence uncertainty/uncertainty adaptive/refinement \
    brain2d-convergence/brain2d-convergence
# Others, and what they are called there.
NEURO_PICTURES := slices=slices resection/slices=resection
LIVER_PICTURES := profile=openings advances=cut retraction=retraction
RESULTS := pipelines/results
# Tables of the studies, and what they are called there.
RESULT_TABLES := brain2d/compare=brain2d brain2d-convergence/convergence=brain2d-convergence brain3d/compare=brain3d brain3d/meshes=brain3d-meshes table1/beside=table1 speed-error/speed-error=speed-error \
    speed-error/reach=reach convergence/convergence=convergence hard/hard=hard hard/summary=hard-summary hard/misses=hard-misses tissue/tissue=tissue \
    estimate/estimate=estimate estimate/summary=estimate-summary foreign/foreign=foreign gallery/phantom=phantom \
    gallery/indentation=indentation adaptive/effectivity=effectivity adaptive/effectivity-summary=effectivity-summary \
    adaptive/refinement=refinement adaptive/reach=refinement-reach adaptive/unattended=unattended neurosurgery/neurosurgery=neurosurgery neurosurgery/volumes=neurosurgery-volumes neurosurgery/rounds=neurosurgery-rounds \
    neurosurgery/seconds=neurosurgery-seconds uncertainty/uncertainty=uncertainty scale/stages=scale \
    scale/64000/pipe=scale-64000 scale/1000000/pipe=scale-1000000 scale/brain-64000/pipe=scale-brain-64000 \
    scale/brain-1000000/pipe=scale-brain-1000000 \
    incision/incision=incision voxels/voxels=voxels voxels/meshes=voxels-meshes neurosurgery/resection/neurosurgery=neurosurgery-resection neurosurgery/electrodes/neurosurgery=neurosurgery-electrodes

.PHONY: readme results
# Only what is newer than the file that is kept.
results:
	@mkdir -p $(RESULTS)
	@for table in $(RESULT_TABLES); do \
	    made=$(OUT)/$${table%=*}.tsv; [ ! -f $$made ] || cp -u $$made $(RESULTS)/$${table#*=}.tsv; \
	done
	printf 'program\tversion\ngmsh\t%s\n' "$$(gmsh --version 2>&1)" > $(RESULTS)/made_with.tsv

readme: export PATH := $(abspath $(BUILD))/bin:$(PATH)
readme: all results
	for text in $(README_TEXTS); do \
	    mkdir -p $(BUILD)/$$(dirname $$text); \
	    KEEP=1 bash pipelines/readme.sh < $$text > $(BUILD)/$$text; \
	    cp $(BUILD)/$$text $$text; \
	done
	for picture in $(README_PICTURES) $(NEURO_PICTURES) $(LIVER_PICTURES:%=incision/%); do \
	    made=$(OUT)/$$picture.png; kept=examples/brain2d/pictures/$$(basename $$picture).png; \
	    case $$picture in incision/*) made=$(OUT)/$${picture%=*}.png; kept=examples/liver/pictures/$${picture#*=}.png ;; *=*) made=$(OUT)/neurosurgery/$${picture%=*}.png; kept=examples/neurosurgery/pictures/$${picture#*=}.png ;; esac; \
	    [ ! $$made -nt $$kept ] || ! command -v convert > /dev/null || convert $$made -resize 70% -colors 128 -strip PNG8:$$kept; \
	done
