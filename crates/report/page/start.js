const data = JSON.parse(document.getElementById("data").textContent);
showTile(data);
showTiles(data);
showMap(data);
