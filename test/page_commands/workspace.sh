workspace --out maps --step 0.2
