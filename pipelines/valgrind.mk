# Not a study: the pipe of the brain section under valgrind, stage by stage: no error, and nothing lost. What libgomp keeps
# for the life of a process is not looked at.

VALGRIND := OMP_NUM_THREADS=1 OMP_WAIT_POLICY=passive valgrind -q --error-exitcode=99 --leak-check=full --show-leak-kinds=definite --errors-for-leak-kinds=definite
VALGRIND_OUT := $(OUT)/valgrind

.PHONY: valgrind
valgrind: export PATH := $(abspath $(BUILD))/bin:$(PATH)
valgrind: all
	@mkdir -p $(VALGRIND_OUT)
	gmsh -2 -v 2 examples/brain2d/brain2d.geo -o $(VALGRIND_OUT)/body.msh
	$(VALGRIND) nodes -u mm $(VALGRIND_OUT)/body.msh > $(VALGRIND_OUT)/nodes.mts
	$(VALGRIND) ipoints $(VALGRIND_OUT)/nodes.mts > $(VALGRIND_OUT)/points.mts
	$(VALGRIND) support $(VALGRIND_OUT)/points.mts > $(VALGRIND_OUT)/lists.mts
	$(VALGRIND) shapefn $(VALGRIND_OUT)/lists.mts > $(VALGRIND_OUT)/table.mts
	$(VALGRIND) mtled examples/brain2d/brain2d.scene $(VALGRIND_OUT)/table.mts > $(VALGRIND_OUT)/u.dat
	$(VALGRIND) fieldcmp $(VALGRIND_OUT)/u.dat $(VALGRIND_OUT)/u.dat > $(VALGRIND_OUT)/compare.tsv
	$(VALGRIND) interp $(VALGRIND_OUT)/u.dat > $(VALGRIND_OUT)/points.dat
	$(VALGRIND) tovtk -o $(VALGRIND_OUT)/u.vtu $(VALGRIND_OUT)/u.dat
	$(VALGRIND) mts check $(VALGRIND_OUT)/table.mts
	@echo "valgrind: no errors, nothing lost"
