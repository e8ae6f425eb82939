cell --door standard_door --robots 2
