recipes draw standard_door --path --out door.svg
recipes check standard_door
recipes check standard_door --robots 2
