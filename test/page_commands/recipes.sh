export DOORMILL_DATABASE=sqlite:///$PWD/recipes.sqlite
recipes list
recipes show standard_door
recipes draw standard_door
recipes check standard_door
recipes export all.xlsx
recipes import all.xlsx
recipes tools import "$ROOT/config/tools.yaml"
recipes tools list
name=$(sed -n 's/^  \([a-z]\w*\):.*/\1/p' "$ROOT/config/tools.yaml" | head -1)
recipes tools show "$name"
recipes tools broken "$name"
recipes tools renew "$name"
