function table = read_table(file)
%READ_TABLE  Reads a table of a sweep or a search: a struct of columns, in which a dot of a name is one of fields.
text = read_text(file);
about = decode_json(read_text([file '-metadata.json']));
described = about.tableSchema.columns;
cells = regexp(text, '("[^"]*(?:""[^"]*)*"|[^,"\n]*)[,\n]', 'tokens');
cells = reshape([cells{:}], numel(described), [])';
table = struct();
for k = 1:numel(described)
    column = cells(2:end, k);
    if strcmp(described(k).datatype, 'string')
        column = strrep(regexprep(column, '^"|"$', ''), '""', '"');
    else
        column = str2double(column);
    end
    parts = field_path(described(k).name);
    table = setfield(table, parts{:}, column);
end
table.provenance = about.urn_hertzline_provenance;
end
